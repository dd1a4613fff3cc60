// Elements of the page. Text is set as text, never as markup: names in files may hold anything.

export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.flat().filter((child) => child !== null && child !== undefined));
  return element;
}

// A name from a file, kept apart from the direction of what is around it.
export const name = (text) => h("bdi", { class: "name" }, text);

let sections = 0;

export function section(title, ...children) {
  const id = `section-${sections++}`;
  return h("section", { "aria-labelledby": id }, h("h2", { id }, title), ...children);
}

// Rows of a term and what is said of it.
export function facts(rows) {
  const pairs = rows.filter((row) => row && row[1] !== null && row[1] !== undefined && row[1] !== "");
  return h("dl", {}, pairs.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
}

export function table(head, rows, label) {
  const cell = (tag, value, i) => h(tag, { class: i > 0 ? "number" : null, scope: tag === "th" ? "col" : null }, value);
  return h(
    "div",
    { class: "scroll" },
    h(
      "table",
      { "aria-label": label },
      h("thead", {}, h("tr", {}, head.map((value, i) => cell("th", value, i)))),
      h("tbody", {}, rows.map((row) => h("tr", {}, row.map((value, i) => cell("td", value, i))))),
    ),
  );
}

export function select(label, options, value, onchange) {
  const list = options.map(([key, text]) => h("option", { value: key, selected: key === value }, text));
  const element = h("select", { onchange: () => onchange(element.value) }, list);
  return { row: h("label", { class: "field" }, h("span", {}, label), element), element };
}

export function toggle(label, checked, onchange, swatch) {
  const box = h("input", { type: "checkbox", checked, onchange: () => onchange(box.checked) });
  const mark = swatch ? h("i", { class: "swatch", style: `background:${swatch}` }) : null;
  return h("label", { class: "toggle" }, box, mark, h("span", {}, label));
}

// One of a few, side by side.
export function choice(label, options, value, onchange) {
  const group = `choice-${sections++}`;
  const buttons = options.map(([key, text]) =>
    h(
      "label",
      {},
      h("input", { type: "radio", name: group, value: key, checked: key === value, onchange: () => onchange(key) }),
      h("span", {}, text),
    ),
  );
  return h("fieldset", { class: "choice" }, h("legend", {}, label), h("div", {}, buttons));
}

export function download(file, blob) {
  const link = h("a", { href: URL.createObjectURL(blob), download: file });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// A colour of the page's theme.
export function themed(variable) {
  return getComputedStyle(document.documentElement).getPropertyValue(variable).trim();
}

// Its parts, 0 to 1.
export function channels(color) {
  const [r, g, b] = [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16) / 255);
  return [r, g, b];
}
