// What this page shows, kept in its address: a copied link restores it.

const DEFAULTS = {
  rig: '',
  channels: ['pinion_ay', 'gear_ay'],
  window: 0.06,
  trigger: 'pinion',
  spectrum: 'gear_ay',
  orders: 'gear_ay',
  scale: 'log',
  range: 12000,
  orderRange: 150,
  waterfall: 'time',
  indicator: 'gear_ay/rms',
  slow: 200,
  theme: '',
};

function fromAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  const view = {...DEFAULTS};
  for (const [name, standard] of Object.entries(DEFAULTS)) {
    if (!given.has(name)) continue;
    const text = given.get(name);
    if (Array.isArray(standard)) view[name] = text.split(',').filter(Boolean).slice(0, 6);
    else if (typeof standard === 'number') view[name] = Number(text) > 0 ? Number(text) : standard;
    else view[name] = text;
  }
  return view;
}

export const view = fromAddress();
const listeners = new Set();

/** Change the view; every listener is told. */
export function change(values) {
  Object.assign(view, values);
  const kept = new URLSearchParams();
  for (const [name, value] of Object.entries(view)) {
    if (String(value) !== String(DEFAULTS[name])) kept.set(name, String(value));
  }
  history.replaceState(null, '', kept.size ? `#${kept}` : location.pathname);
  for (const listener of listeners) listener(view);
}

export function onChange(listener) {
  listeners.add(listener);
}

window.addEventListener('hashchange', () => change(fromAddress()));
