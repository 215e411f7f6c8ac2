import { expect, test } from 'vitest';
import { beginLooking } from './looking';
import { PageStorage } from './storages';
import { storeShow } from './view_options';

const note = `note=${'a'.repeat(26)}`;
const box = 'axes=1,0,0,0,-1,0&clip=0,0,0,1,1,1';

function begun(view: string, browser = new PageStorage()) {
  return beginLooking('one', { view, browser, tab: new PageStorage() });
}

test('an address opens the view that it was taken from', () => {
  for (const view of ['', note, box, `${box}&${note}`]) expect(begun(view).query()).toBe(view);
});

test('what the address does not know is left out of the one that is told', () => {
  expect(begun(`frame=3&${note}`).query()).toBe(note);
});

test('the address that is told is that of now', () => {
  const { cutting, query } = begun(`${box}&${note}`);
  cutting.dispatch({ kind: 'clip', on: false });
  expect(query()).toBe(note);
});

test('what the browser remembers is shown', () => {
  const browser = new PageStorage();
  storeShow(browser, 'points');
  expect(begun('', browser).options.get().show).toBe('points');
});
