// Methods of viser's and three's objects that the page replaces for as long as it draws with them.

// Replace a method of an object until the life ends. make(earlier): the new method.
/**
 * @template {object} T @template {keyof T} K
 * @param {import("../core/life.js").Life} life @param {T} object @param {K} name @param {(earlier: T[K]) => T[K]} make
 */
export function wrapMethod(life, object, name, make) {
  const earlier = object[name];
  const made = /** @type {T[K] & { springtideEarlier: T[K] }} */ (make(earlier));
  made.springtideEarlier = earlier; // tests draw with it
  object[name] = made;
  life.own(() => (object[name] = earlier));
}
