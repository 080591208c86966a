// Rules for the scripts of the page; the oldest browsers are those of docs/platforms.md.

import js from "@eslint/js";
import compat from "eslint-plugin-compat";
import globals from "globals";

export default [
  js.configs.recommended,
  compat.configs["flat/recommended"],
  {
    languageOptions: { ecmaVersion: 2023, sourceType: "module", globals: globals.browser },
    rules: { eqeqeq: "error", "no-var": "error", "prefer-const": ["error", { destructuring: "all" }] },
    settings: { browsers: ["chrome 120", "edge 120", "firefox 121", "safari 17.4"] },
  },
  { files: ["**/before/*.js"], languageOptions: { sourceType: "script" } },
  {
    files: ["**/before/failures.js"], // it runs in older browsers too
    languageOptions: { ecmaVersion: 5, globals: globals.builtin },
    rules: { "no-var": "off", "no-unused-vars": ["error", { caughtErrors: "none" }], "compat/compat": "off" },
  },
  { files: ["**/*.test.js"], languageOptions: { globals: globals.node } },
];
