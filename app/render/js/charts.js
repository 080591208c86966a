// Gaps in the charts: uPlot leaves a gap at null only, and viser sends arrays of numbers, in which NaN means no value.
//
// Of viser this file uses window.__viserTestpoints.uplots, the charts of the page.

(() => {
  "use strict";
  const SEARCH_INTERVAL = 200; // [ms] between two looks for new charts

  // uPlot asks this for the parts of a line that are not drawn: [from, to] along x [pixels of the canvas].
  function gapsAtNaN(chart, series, first, last) {
    const [x] = chart.data, y = chart.data[series], gaps = [];
    const place = (k) => chart.valToPos(x[Math.min(Math.max(k, first), last)], "x", true);
    for (let k = first; k <= last; k++) {
      if (!Number.isNaN(y[k])) continue;
      const start = k;
      while (k < last && Number.isNaN(y[k + 1])) k++;
      gaps.push([place(start - 1), place(k + 1)]);
    }
    return gaps;
  }

  setInterval(() => {
    const charts = (window.__viserTestpoints && window.__viserTestpoints.uplots) || {};
    for (const { chart } of Object.values(charts)) {
      const without = chart.series.filter((series, k) => k > 0 && series.gaps !== gapsAtNaN);
      for (const series of without) series.gaps = gapsAtNaN;
      if (without.length) chart.redraw();
    }
  }, SEARCH_INTERVAL);
})();
