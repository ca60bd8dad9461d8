// Makes and updates the elements of the column of figures.

export const byId = (id: string): HTMLElement => document.getElementById(id)!;

export function element(tag: string, className: string, text: string): HTMLElement {
  const made = document.createElement(tag);
  made.className = className;
  made.textContent = text;
  return made;
}

/** A table of names and values. */
export function table(rows: [string, string][]): HTMLElement {
  const made = document.createElement("table");
  for (const [name, value] of rows) {
    const row = document.createElement("tr");
    row.append(element("td", "dim", name), element("td", "", value));
    made.append(row);
  }
  return made;
}

/** A list of items, each a class of CSS and a text. */
export function list(items: [string, string][]): HTMLElement {
  const made = document.createElement("ul");
  for (const [className, text] of items) made.append(element("li", className, text));
  return made;
}

/** Changes a panel to this content where it differs, so that a selection or a scroll survives. */
export function set(id: string, ...content: HTMLElement[]): void {
  const made = document.createElement("div");
  made.append(...content);
  adapt(byId(id), made);
}

/** Gives `shown` the children of `made`. Children that are equal stay as they are, since drawing text again takes most of a
 *  software driver's time. */
function adapt(shown: Element, made: Element): void {
  const before = [...shown.childNodes];
  [...made.childNodes].forEach((child, i) => {
    const old = before[i];
    if (!old) shown.append(child);
    else if (old.isEqualNode(child)) return;
    else if (old instanceof Text && child instanceof Text) old.data = child.data;
    else if (old instanceof Element && child instanceof Element && mayAdapt(old, child)) adaptElement(old, child);
    else old.replaceWith(child);
  });
  for (const old of before.slice(made.childNodes.length)) old.remove();
}

/** Whether an element may be changed in place. An element with a button is replaced as a whole, because the button's handler
 *  belongs to the content that it was made with. */
function mayAdapt(shown: Element, made: Element): boolean {
  const hasButton = (element: Element): boolean => element.matches("button") || element.querySelector("button") !== null;
  return shown.nodeName === made.nodeName && !hasButton(shown) && !hasButton(made);
}

/** Gives `shown` the attributes and children of `made`. */
function adaptElement(shown: Element, made: Element): void {
  for (const { name } of [...shown.attributes]) if (!made.hasAttribute(name)) shown.removeAttribute(name);
  for (const { name, value } of made.attributes) if (shown.getAttribute(name) !== value) shown.setAttribute(name, value);
  adapt(shown, made);
}
