// How the search of the site orders what it finds (html_search_scorer): answers before guides, guides before what lists or records.
var Scorer = {
  score: ([page, title, , , score, , kind]) => {
    const places = [[/^how\//, 25], [/^(changelog|license|contributing|architecture)$/, -12], [/^(tutorial|jobs)\/|^[a-z-]+$/, 3], [/^(api|python-api)\//, -2],
      [/^verification\//, -4]];
    const place = places.find(([pattern]) => pattern.test(page));
    if (kind === "object") return score; // a name of the interface that was typed in full comes first
    const words = (new URLSearchParams(window.location.search).get("q") ?? "").toLowerCase().match(/\w{3,}/g) ?? [];
    return score + (place ? place[1] : 0) + words.filter((word) => title.toLowerCase().includes(word)).length;
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
