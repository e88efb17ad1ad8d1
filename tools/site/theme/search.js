// Search in the page: its index is a script (search/index.js), so that it needs no server.
// A section is found when it has every word of the query; words in its title count more, those of a long text less.
(function () {
  const field = document.getElementById("query");
  const results = document.getElementById("results");

  function add(parent, tag, text) {
    const element = document.createElement(tag);
    element.textContent = text;
    return parent.appendChild(element);
  }

  // How well a place of a page matches; 0: not at all.
  function score(place, words) {
    const title = place.title.toLowerCase(), text = place.text.toLowerCase();
    let sum = 0;
    for (const word of words) {
      const here = (title.includes(word) ? 20 : 0) + (text.split(word).length - 1) / (1 + text.length / 1000);
      if (here === 0) return 0;
      sum += here;
    }
    return sum;
  }

  function show() {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = places.map((place) => ({ place, score: score(place, words) })).filter((hit) => hit.score > 0);
    found.sort((a, b) => b.score - a.score);
    results.textContent = "";
    add(results, "p", found.length + " places" + (found.length > 50 ? ", the first 50:" : ""));
    for (const { place } of found.slice(0, 50)) {
      add(add(results, "h3", ""), "a", place.title).href = place.location;
      add(results, "p", place.location).className = "path";
      const begin = Math.max(place.text.toLowerCase().indexOf(words[0]) - 80, 0);
      add(results, "p", (begin > 0 ? "... " : "") + place.text.slice(begin, begin + 240));
    }
  }

  field.value = new URLSearchParams(window.location.search).get("q") || "";
  field.addEventListener("input", show);
  show();
})();
