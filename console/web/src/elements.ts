// Parts of the column of figures.

export const byId = (id: string): HTMLElement => document.getElementById(id)!;

export function element(tag: string, className: string, text: string): HTMLElement {
  const made = document.createElement(tag);
  made.className = className;
  made.textContent = text;
  return made;
}

export function table(rows: [string, string][]): HTMLElement {
  const made = document.createElement("table");
  for (const [name, value] of rows) {
    const row = document.createElement("tr");
    row.append(element("td", "dim", name), element("td", "", value));
    made.append(row);
  }
  return made;
}

export function list(items: [string, string][]): HTMLElement {
  const made = document.createElement("ul");
  for (const [className, text] of items) made.append(element("li", className, text));
  return made;
}

/** Replaces a panel's content if it differs, so that a selection or a scroll survives. */
export function set(id: string, ...content: HTMLElement[]): void {
  const panel = byId(id);
  const made = document.createElement("div");
  made.append(...content);
  if (panel.innerHTML !== made.innerHTML) panel.replaceChildren(...made.childNodes);
}
