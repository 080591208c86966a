// The only global name of the page: for tests, for the page with the panes, and for the scripts before viser's client.
//
// fail(words): show a failure on the cover (before/failures.js). page: the name of this page. line: the connection to the lab
// (before/connection.js): the number of messages heard and of beats, the time [s] to wait for a large message on its way,
// whether it is open, close(), and hurry(time [ms]), which shortens the attempt to connect. isRecording: true while a clip is
// recorded. awaitPicture(): the scene is another one. showsWhole(): true if the canvas shows its complete picture
// (page/cover.js). isWhole: true once the first picture of the scene was complete; areWhole(): the same of all frames
// (beside/main.js). quality, memory, skiesDrawn, contexts: for tests. beside: true on the page with the panes
// (beside/main.js). channel: to the lab, for the page with the panes (core/channel.js).

/** @type {Springtide} */
export const springtide = (globalThis.__springtide ??= {});
