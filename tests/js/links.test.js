import assert from "node:assert/strict";
import { test } from "node:test";
import { labAt, ofLab, setupIn } from "./js/sharing/links.js";

test("the lab gets of an address what viser's client does not take", () => {
  assert.equal(ofLab("?scene=rope&darkMode&fixedDpr=2&length=1/2&hideViserLogo"), "?scene=rope&length=1%2F2");
  assert.equal(ofLab("?websocket=wss://other&playbackPath=a&showStats"), "?");
  assert.equal(ofLab("?note=100+%25&note=%C3%BC"), "?note=100+%25&note=%C3%BC");
});

test("a link names the lab and not a pane of several, behind a proxy too", () => {
  const origin = "http://127.0.0.1:8080";
  const paths = ["/", "/user/a/proxy/8080/", "/pane/2/", "/user/a/proxy/8080/pane/1/index.html"];
  const found = paths.map((pathname) => labAt({ origin, pathname }));
  assert.deepEqual(found, [`${origin}/`, `${origin}/user/a/proxy/8080/`, `${origin}/`, `${origin}/user/a/proxy/8080/`]);
});

test("the set-up of a replay is its last block, and of another page there is none", () => {
  const block = (/** @type {string} */ text) => `<script type="application/json" id="springtide-setup">${text}</script>`;
  assert.equal(setupIn(`<html>${block("first")}<p></p>${block('{"a": 1}')}<script>1</script>`), '{"a": 1}');
  assert.equal(setupIn("<html><script>1</script>"), null);
});
