// How the search of the site orders what it finds (html_search_scorer): answers before guides, guides before what lists or records.
var Scorer = {
  score: ([page, , , , score, , kind]) => {
    const places = [[/^how\//, 25], [/^(changelog|license|contributing|architecture)$/, -12], [/^(tutorial|jobs)\/|^[a-z-]+$/, 3], [/^(api|python-api)\//, -2],
      [/^verification\//, -4]];
    const place = places.find(([pattern]) => pattern.test(page));
    // A name of the interface that was typed in full comes first.
    return score + (kind === "object" ? 0 : place ? place[1] : 0);
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
