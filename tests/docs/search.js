// Asks the search of the site as its page does: node search.js HTML QUESTIONS, or HTML --query WORDS, which shows the hits. Each line of
// QUESTIONS is a question => pages that answer it. At least nine in ten have one of these within the first three hits, two in three as the first.
"use strict";
const fs = require("fs"), path = require("path"), vm = require("vm");

/** [page#section, title, score] of the hits, best first. */
function ask(html, query) {
  const context = { location: { search: "?q=" + encodeURIComponent(query) }, document: { getElementById: () => null }, localStorage: { setItem() {} },
    SPHINX_HIGHLIGHT_ENABLED: false, URLSearchParams, _: (text) => text, _ready() {} };
  context.window = context;
  vm.createContext(context);
  for (const file of ["_static/searchtools.js", "_static/language_data.js", "searchindex.js"])
    vm.runInContext(fs.readFileSync(path.join(html, file), "utf8"), context);
  return vm.runInContext(`Search._performSearch(...Search._parseQuery(${JSON.stringify(query)}))`, context).reverse().map((hit) => [hit[0] + hit[2], hit[1], hit[4]]);
}

const [html, questions, ...words] = process.argv.slice(2);
if (!fs.existsSync(path.join(html, "searchindex.js"))) {
  console.log(`no site in ${html}`);
  process.exit(77);
}
if (questions === "--query") {
  for (const [page, title, score] of ask(html, words.join(" ")).slice(0, 10)) console.log(`${score.toFixed(1)}  ${page}  ${title}`);
} else {
  let count = 0, first = 0, three = 0, missing = 0;
  for (const line of fs.readFileSync(questions, "utf8").split("\n").filter((text) => text && text[0] !== "#")) {
    const [query, wanted] = line.split("=>").map((text) => text.trim()), pages = wanted.split(/,\s*/), hits = ask(html, query);
    const place = hits.findIndex(([page]) => pages.includes(page.split("#")[0]));
    count++;
    first += place === 0;
    three += place >= 0 && place < 3;
    if (place < 0 || place > 2) console.log(`${query}: ${place < 0 ? "not found" : `place ${place + 1}`}, behind ${hits.slice(0, 3).map(([page]) => page).join(", ")}`);
    for (const page of pages) if (!fs.existsSync(path.join(html, page + ".html"))) console.log(`${query}: no page ${page}`, ++missing);
  }
  console.log(`${count} questions: ${first} answered by the first hit, ${three} within three`);
  process.exit(count && !missing && three >= 0.9 * count && first >= count * 2 / 3 ? 0 : 1);
}
