// Puts the page of a lab into a box of a notebook. The browser reaches the lab directly where both run on one machine,
// otherwise through jupyter-server-proxy. The key in the path is the lab's own: another server on that port has none.

(async (given) => {
  "use strict";
  const { box, port, key, height } = given;
  const element = document.getElementById(box);
  const direct = `http://127.0.0.1:${port}/${key}/`;
  const isLocal = ["localhost", "127.0.0.1", "[::1]", ""].includes(location.hostname) || !/^http/.test(location.protocol);

  function proxied() {
    const settings = document.getElementById("jupyter-config-data");
    const base = settings ? JSON.parse(settings.textContent).baseUrl : document.body.dataset.baseUrl;
    return base ? new URL(`${base.replace(/\/$/, "")}/proxy/${port}/${key}/`, location.href).href : "";
  }

  async function answers(address) {
    try {
      return address !== "" && (await fetch(`${address}springtide-alive`, { cache: "no-store" })).ok;
    } catch {
      return false;
    }
  }

  for (const address of isLocal ? [direct, proxied()] : [proxied(), direct]) {
    if (!(await answers(address))) continue;
    const page = document.createElement("iframe");
    page.src = `${address}index.html`;
    page.title = "Springtide";
    page.allow = "clipboard-write; fullscreen";
    page.style.cssText = `width: 100%; height: ${height}px; border: 0;`;
    element.replaceChildren(page);
    return;
  }
  element.textContent =
    "The lab of this cell does not answer: it has ended, and running the cell again starts it. " +
    "Where the kernel runs on another machine, its Jupyter needs jupyter-server-proxy.";
})
