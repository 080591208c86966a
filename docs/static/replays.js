// Each replay is a viewer that draws continuously, so its frame exists only while it is in view.
// There is no room for the texts of a replay; what is drawn does not fade in, as that takes seconds without a graphics card.
const IN_A_PAGE =
  "#springtide-slow, #springtide-about { display: none !important } canvas[data-engine] { opacity: 1 !important }";
const FADE_IN = 1500; // [ms] from its page to its first picture

const watcher = new IntersectionObserver(
  (entries) => {
    for (const { target, isIntersecting } of entries) {
      if (!isIntersecting) target.replaceChildren();
      else if (!target.firstChild) target.append(replay(target.dataset));
    }
  },
  { threshold: 0.5 },
);

function replay({ replay: address, title }) {
  const frame = document.createElement("iframe");
  Object.assign(frame, { src: address, title: `Replay: ${title}` });
  frame.addEventListener("load", () => {
    const style = frame.contentDocument?.createElement("style"); // none where the site is read from files
    if (style) style.textContent = IN_A_PAGE;
    if (style) frame.contentDocument.head.append(style);
    setTimeout(() => frame.classList.add("is-drawn"), FADE_IN);
  });
  return frame;
}

document.addEventListener("DOMContentLoaded", () => {
  for (const place of document.querySelectorAll("[data-replay]")) watcher.observe(place);
});
