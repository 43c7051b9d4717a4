/** Keys: everything that buttons do, and a little more. */

/** @typedef {import("./controls.js").Controls} Controls */

/** @type {Record<string, (controls: Controls, event: KeyboardEvent) => void>} */
const KEYS = {
  " ": ({ clock }) => clock.toggle(),
  ArrowRight: ({ clock }, event) => clock.step(event.shiftKey ? 10 : 1),
  ArrowLeft: ({ clock }, event) => clock.step(event.shiftKey ? -10 : -1),
  ArrowUp: ({ clock }) => clock.shift(1),
  ArrowDown: ({ clock }) => clock.shift(-1),
  Home: ({ clock }) => clock.seek(0),
  End: ({ clock }) => clock.seek(clock.last),
  "+": (controls) => controls.zoom(1.4),
  "=": (controls) => controls.zoom(1.4),
  "-": (controls) => controls.zoom(1 / 1.4),
  0: ({ stage }) => stage.home(),
  l: (controls) => controls.toggleLoop(),
  t: (controls) => controls.toggleTheme(),
  f: (controls) => controls.fullScreen(),
  n: (controls) => controls.nextAgent(1),
  p: (controls) => controls.nextAgent(-1),
  c: (controls) => controls.toggleFollow(),
  Escape: ({ stage }) => stage.choose(-1),
  "?": (controls) => controls.help.showModal(),
};

/** Listen to the keyboard. @param {Controls} controls */
export function listenToKeys(controls) {
  document.addEventListener("keydown", (event) => {
    const { target } = event;
    if (controls.help.open || event.ctrlKey || event.metaKey || event.altKey || document.body.dataset.view !== "player") return;
    if (target instanceof HTMLSelectElement) return;
    const pressed = target instanceof HTMLButtonElement || (target instanceof HTMLInputElement && target.type === "checkbox");
    if (pressed && (event.key === " " || event.key === "Enter")) return;
    const act = KEYS[event.key];
    if (!act) return;
    event.preventDefault();
    act(controls, event);
  });
}
