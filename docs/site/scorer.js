// How the search of the site finds and orders pages (html_search_scorer: part of Sphinx' language_data.js, which stands behind searchtools.js).
// Sphinx shows pages that have all words of a question; here a page may lack some. Each word counts by its rarity (inverse document
// frequency), less on long pages (BM25; the index knows that a page has a word, not how often), more in titles. The link leads to the section
// whose title has the most of the question.

// Words of a question that say nothing of its subject.
const askingWords = new Set(("how what which why where when who can could should would do does did is are was i me my we our you your it its a an " +
  "the of to in on at by for from with and or if there get make use want need have has not no libmps mps").split(" "));
// Words of everyday use and of other codes, with those of these pages.
const sameWords = ["film movie video animation", "picture plot figure draw image", "restart resume continue checkpoint", "stop abort cancel interrupt",
  "slow fast performance faster", "thread core cpu processor parallel", "rank mpi", "memory ram", "license licence", "eigenmode eigenfrequency mode", "read load import open", "write export save output",
  "hdf5 h5 vtkhdf", "boundary side condition", "earthquake quake seismic", "absorbing quiet viscous", "noise noisy oscillation",
  "settlement displacement", "friction rough roughness", "accuracy accurate verification validation benchmark", "law material constitutive",
  "install setup pip", "ground soil", "k0 geostatic", "moving motion", "velocity speed"];
// What stands for a kind of page: answers before guides, guides before what lists or records.
const pageWeights = [[/^how\//, 1.4], [/^how$|^(changelog|license|contributing|architecture|interface|references|papers|extend|domain|examples)$/, 0.55],
  [/^coming-from$/, 0.8], [/^(tutorial|jobs)\//, 1], [/^[a-z-]+$/, 1.15], [/^programs\//, 0.8], [/^(api|python-api)\//, 0.6], [/^verification\//, 0.7],
  [/^theory\//, 0.85]];
const pageWeight = (page) => pageWeights.find(([pattern]) => pattern.test(page))?.[1] ?? 1;

var splitQuery = (query) => {
  const words = query.split(/[^\p{Letter}\p{Number}_]+/gu).filter((word) => word);
  const kept = words.filter((word) => !askingWords.has(word.toLowerCase()));
  return kept.length ? kept : words;
};

/** Lengths of the pages, stems of their titles and of those of sections, and words of the same meaning: once. */
const searchTables = (index) => {
  const stemmer = new Stemmer(), count = index.docnames.length, length = new Array(count).fill(0);
  const stems = (text) => new Set(splitQuery(text ?? "").map((word) => stemmer.stemWord(word.toLowerCase())));
  for (const pages of Object.values(index.terms)) for (const page of [pages].flat()) length[page]++;
  const mean = length.reduce((sum, n) => sum + n, 0) / count;
  const sections = Object.entries(index.alltitles).flatMap(([title, places]) => places.map(([page, id]) => ({ page, id, title, stems: stems(title) })));
  const same = new Map();
  for (const group of sameWords) for (const word of stems(group)) same.set(word, [...stems(group)].filter((other) => other !== word));
  return { count, sections, same, titles: index.titles.map(stems), shortness: length.map((n) => 2.2 / (1 + 1.2 * (0.4 + 0.6 * n / mean))) };
};

/** For each word of the question: its rarity, and how well each page has it (1 the word, 0.7 a part of one, 0.6 one of the same meaning). */
const wordsOnPages = (index, { count, same }, asked) => asked.map((word) => {
  const found = new Map();
  const add = (term, share) => {
    for (const table of [index.terms, index.titleterms])
      if (Object.hasOwn(table, term)) for (const page of [table[term]].flat()) found.set(page, Math.max(share, found.get(page) ?? 0));
  };
  add(word, 1);
  if (!found.size && word.length > 3) for (const term of Object.keys(index.terms)) if (term.startsWith(word)) add(term, 0.7);
  const own = found.size, others = same.get(word) ?? [];
  for (const other of others) add(other, 0.6);
  const pages = own || found.size;
  return { word, others, found, rarity: pages ? 1 + Math.log(1 + (count - pages + 0.5) / (pages + 0.5)) : 0 };
});

let madeTables = null;
/** The pages that have words of the question, each with its best section. */
Search.performTermsSearch = (asked) => {
  const index = Search._index, tables = (madeTables ??= searchTables(index)), words = wordsOnPages(index, tables, [...asked]);
  const total = words.reduce((sum, { rarity }) => sum + rarity, 0), text = new Map(), best = new Map();
  if (!total) return [];
  for (const { found, rarity } of words) for (const [page, share] of found) text.set(page, (text.get(page) ?? 0) + share * rarity / total);
  const share = (stems) => words.reduce((sum, { word, others, rarity }) =>
    sum + rarity * (stems.has(word) ? 1 : others.some((other) => stems.has(other)) ? 0.6 : 0), 0) / total;
  for (const section of tables.sections) {
    const has = share(section.stems), precise = has * has / (has + 0.04 * section.stems.size); // long titles have many words
    if (has && precise > (best.get(section.page)?.precise ?? 0)) best.set(section.page, { section, has, precise });
  }
  return [...text].map(([page, covered]) => {
    const name = index.docnames[page], title = share(tables.titles[page]), found = best.get(page);
    const score = 10 * pageWeight(name) * (covered ** 1.5 * tables.shortness[page] + 0.8 * title + 0.6 * (found?.precise ?? 0));
    const inner = found && found.section.id !== null && found.precise > 0.3 && found.has > title ? found.section : null;
    return [name, inner ? `${index.titles[page]} > ${inner.title}` : index.titles[page], inner ? `#${inner.id}` : "", null, score, index.filenames[page], "text"];
  }).sort((a, b) => b[4] - a[4]).slice(0, 40);
};

var Scorer = {
  score: ([page, , , , score, , kind]) => {
    if (kind === "text") return score;
    if (kind === "object") return /[_.]|[a-z][A-Z]/.test(new URLSearchParams(window.location.search).get("q") ?? "") ? score + 20 : score / 3; // a name of the interface
    return 1.5 * score * pageWeight(page); // a title that has the question as it stands
  },
  objNameMatch: 30,
  objPartialMatch: 6,
  objPrio: {0: 15, 1: 5, 2: -5},
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
