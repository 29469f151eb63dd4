// The page: messages from the server go to the panels, the view goes to the server.

import {Connection} from './connection.js';
import {isDark} from './colours.js';
import {Controls} from './panels/controls.js';
import {Diagnosis} from './panels/diagnosis.js';
import {Indicators} from './panels/indicators.js';
import {Scope} from './panels/scope.js';
import {Section} from './panels/section.js';
import {Spectrum} from './panels/spectrum.js';
import {StateLine} from './panels/state.js';
import {Waterfall} from './panels/waterfall.js';
import {Wheels} from './panels/wheels.js';
import {change, onChange, view} from './view.js';

function useTheme() {
  const dark = view.theme ? view.theme === 'dark' : matchMedia('(prefers-color-scheme: dark)').matches;
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
}

useTheme();
const state = new StateLine();
const scope = new Scope();
const wheels = new Wheels();
const spectrum = new Spectrum('spectrum', {
  title: 'Spectrum', table: 'spectrum', xLabel: 'frequency [Hz]', range: 'range',
  ranges: [1000, 3000, 6000, 12000, 26000, 100000],
});
const orders = new Spectrum('orders', {
  title: 'Order spectrum', table: 'order_spectrum', xLabel: 'order of the pinion’s shaft', range: 'orderRange',
  ranges: [10, 50, 150, 400, 1000],
});
const section = new Section();
const waterfall = new Waterfall();
const indicators = new Indicators();
const diagnosis = new Diagnosis();

const takers = {
  hello: (message) => controls.build(message),
  waiting: ({text}) => state.say(text),
  refused: ({text}) => state.say(text, 6),
  state(message) {
    for (const panel of [state, controls, scope, wheels, spectrum, orders, section, waterfall, indicators, diagnosis]) {
      panel.describe(message);
    }
  },
  scope(message) {
    scope.draw(message);
    wheels.take(message);
    // The next frame is sent when this one is on the screen.
    requestAnimationFrame(() => connection.send({type: 'ready'}));
  },
  table(message) {
    for (const panel of [spectrum, orders, waterfall]) panel.take(message);
  },
  points: (message) => section.take(message),
};

const connection = new Connection(
  (message) => takers[message.type]?.(message),
  () => state.say('the server is gone; the page goes on when it is back'));
const controls = new Controls(connection);

function look() {
  const {rig, channels, window: seconds, trigger} = view;
  connection.show({rig, channels, window: seconds, trigger, pixels: scope.pixels});
}

look();
onChange(look);
addEventListener('resize', look);
document.getElementById('theme').addEventListener('click', () => change({theme: isDark() ? 'light' : 'dark'}));
onChange(() => {
  const before = document.documentElement.dataset.theme;
  useTheme();
  if (document.documentElement.dataset.theme === before) return;
  scope.rebuild();
  for (const panel of [spectrum, orders, indicators]) panel.rebuild();
  section.redraw();
  waterfall.draw();
});
