// A choice of one of a few, side by side.
import { element } from './dom';

export interface Segments<Name extends string> {
  readonly element: HTMLElement;
  check(name: Name): void;
}

export function segments<Name extends string>(
  group: string,
  legend: string,
  names: readonly Name[],
  labels: Record<Name, string>,
  choose: (name: Name) => void,
): Segments<Name> {
  const inputs = names.map((name) => {
    const input = element('input', { type: 'radio', name: group, value: name });
    input.addEventListener('change', () => choose(name));
    return input;
  });
  const choices = names.map((name, i) =>
    element('label', {}, inputs[i]!, element('span', {}, labels[name])),
  );
  return {
    element: element(
      'fieldset',
      { class: `segments ${group}` },
      element('legend', { class: 'unseen' }, legend),
      ...choices,
    ),
    check(chosen) {
      names.forEach((name, i) => (inputs[i]!.checked = name === chosen));
    },
  };
}
