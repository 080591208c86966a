// The channel between this page and the lab: topics, down and up (app/render/handles/channel.py is its other end).
//
// Down, each topic has a state, in an element of the panel. Up, messages go through the hidden field that topic "field" names,
// on topics that the lab listens to. Each has the name of this page and a number. A message on another topic waits: the lab
// may not have opened its panel yet.

import { springtide } from "./springtide.js";
import { connectionNumber, PAGE, send } from "./viewer.js";
import { onChange, onLook } from "./watch.js";

const PATIENCE = 60_000; // [ms] after a question was sent first, in which it is asked again in a new panel
/** @typedef {(state: any) => void} Listener */

/** @type {Record<string, { text: string, state: any }>} */
let states = {};
/** @type {Record<string, Listener[]>} */
const listeners = {};
let count = 0; // messages sent

// The state of a topic; undefined while the lab has none.
/** @param {string} topic */
export const topicState = (topic) => states[topic]?.state;

// Call a function with each new state of a topic, and with the present one.
/** @param {string} topic @param {Listener} call */
export function onTopic(topic, call) {
  (listeners[topic] ??= []).push(call);
  call(topicState(topic));
}

function read() {
  const before = states;
  states = {};
  for (const element of document.querySelectorAll("[data-springtide-topic]")) {
    const { springtideTopic: topic = "", value: text = "null" } = element.dataset;
    states[topic] = before[topic]?.text === text ? before[topic] : { text, state: JSON.parse(text) };
  }
  for (const topic of Object.keys({ ...before, ...states })) {
    if (before[topic] !== states[topic]) for (const call of listeners[topic] ?? []) call(topicState(topic));
  }
  settle();
  post();
}

// The field of the present panel, if there is a connection and the lab listens to a topic. A name of both is the address.
/** @param {string} topic */
function addressOf(topic) {
  const field = topicState("field");
  return field?.topics.includes(topic) ? `${connectionNumber()} ${field.uuid}` : "";
}

/** @param {string} topic @param {number} number @param {unknown} value */
const put = (topic, number, value) => send(topicState("field").uuid, `${PAGE} ${number} ${topic}\n${JSON.stringify(value)}`);

// Send a message once. False without a lab that listens.
/** @param {string} topic @param {unknown} value */
export const say = (topic, value) => Boolean(addressOf(topic)) && put(topic, ++count, value);

/** @type {Map<string, { text: string, sentTo: string }>} */
const told = new Map(); // topic -> what the lab is to know of this page

// Have the lab know a state of this page, in each panel and on each connection.
/** @param {string} topic @param {unknown} state */
export function tell(topic, state) {
  const text = JSON.stringify(state);
  if (told.get(topic)?.text !== text) told.set(topic, { text, sentTo: "" });
  post();
}

/**
 * @typedef {{ number: number, value: unknown, sentTo: string, until: number, resolve: (answer: any) => void,
 *   reject: (reason: Error) => void }} Question
 */
/** @type {Map<string, Question>} */
const questions = new Map(); // topic -> its unanswered question

// Ask the lab, again in each panel until it answers. Resolves with the answer. Rejects with an Error: "late" after `within` [ms],
// whether or not a lab listens, or after PATIENCE; "asked again" if another question of the topic follows.
/** @param {string} topic @param {unknown} value @param {number} within @returns {Promise<any>} */
export function ask(topic, value, within = Infinity) {
  questions.get(topic)?.reject(new Error("asked again"));
  return new Promise((resolve, reject) => {
    questions.set(topic, { number: ++count, value, sentTo: "", until: performance.now() + within, resolve, reject });
    post();
  });
}

// Resolve the questions that have an answer.
function settle() {
  for (const [page, number, answer] of topicState("answers") ?? []) {
    for (const [topic, question] of questions) {
      if (page !== PAGE || number !== question.number) continue;
      questions.delete(topic);
      question.resolve(answer);
    }
  }
}

// Send what the present panel has not had yet.
function post() {
  for (const [topic, one] of told) {
    const to = addressOf(topic);
    if (to && to !== one.sentTo && put(topic, ++count, JSON.parse(one.text))) one.sentTo = to;
  }
  const now = performance.now();
  for (const [topic, one] of questions) {
    const to = addressOf(topic);
    if (now > one.until) {
      questions.delete(topic);
      one.reject(new Error("late"));
    } else if (to && to !== one.sentTo && put(topic, one.number, one.value)) {
      one.sentTo = to;
      one.until = Math.min(one.until, now + PATIENCE);
    }
  }
}

springtide.channel = { topicState, say };
onChange(read);
onLook(post); // a new connection changes no element, and a question may be late
