// Methods of viser's and three's objects that the page replaces for as long as it draws with them.

// Replace a method of an object until the life ends. make(earlier): the new method.
export function wrapMethod(life, object, name, make) {
  const earlier = object[name];
  object[name] = make(earlier);
  object[name].springtideEarlier = earlier; // tests draw with it
  life.own(() => (object[name] = earlier));
}
