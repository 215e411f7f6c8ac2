// Building elements without a framework.

type Attributes = Readonly<Record<string, string | number | boolean | null>>;
type Child = Node | string | null;

// Attributes that are null or false are left out. Children that are null too.
export function element<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[Tag] {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== null && value !== false)
      node.setAttribute(name, value === true ? '' : String(value));
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

// A button that sends no form; its class is `button` unless it has another one.
export function buttonOf(child: Child, attributes: Attributes = {}): HTMLButtonElement {
  return element('button', { type: 'button', class: 'button', ...attributes }, child);
}

// Writing the same text again would make screen readers repeat it.
export function setText(node: Element, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

export interface Panel {
  readonly element: HTMLElement;
  dispose(): void;
}
