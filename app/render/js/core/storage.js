// The local storage of the browser, which may refuse: cookies are blocked, or another site shows the page in a frame.

/** @type {Map<string, string>} */
const unstored = new Map(); // refused values, for as long as the page

/** @param {string} key */
export function stored(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return unstored.get(key) ?? null;
  }
}

// False if the browser refuses: the value then holds until the page is left.
/** @param {string} key @param {string} text */
export function store(key, text) {
  try {
    localStorage.setItem(key, text);
    return true;
  } catch {
    unstored.set(key, text);
    return false;
  }
}
