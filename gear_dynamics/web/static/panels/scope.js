// The oscilloscope: chosen channels over a window that begins at a revolution or a tooth.

import {Chart} from '../chart.js';
import {lineColour} from '../colours.js';
import {Panel, choice, make} from '../panel.js';
import {label, unitOf} from '../units.js';
import {change, onChange, view} from '../view.js';

const WINDOWS = [0.005, 0.01, 0.02, 0.06, 0.12, 0.5, 1, 2, 4];
const TRIGGERS = {none: 'free', pinion: 'at a pinion revolution', gear: 'at a gear revolution', tooth: 'at a tooth'};

export class Scope {
  constructor() {
    const windows = choice('window', WINDOWS.map(String), String(view.window),
      (text) => change({window: Number(text)}));
    for (const option of windows.options) {
      const seconds = Number(option.value);
      option.textContent = seconds < 1 ? `${Number((seconds * 1000).toPrecision(4))} ms` : `${seconds} s`;
    }
    const trigger = choice('trigger', Object.keys(TRIGGERS), view.trigger,
      (text) => change({trigger: text}));
    for (const option of trigger.options) option.textContent = TRIGGERS[option.value];
    this.add = choice('add a channel', ['channels …'], 'channels …', (name) => this.toggle(name));
    this.panel = new Panel('scope', 'Oscilloscope', {
      canvas: () => this.chart?.canvas,
      table: () => [['t', ...this.names], this.data ?? []],
      tools: [this.add, windows, trigger],
    });
    this.legend = make('div', {className: 'legend'});
    this.panel.element.append(this.legend);
    this.names = [];
    onChange(() => {
      windows.value = String(view.window);
      trigger.value = view.trigger;
    });
  }

  toggle(name) {
    this.add.value = 'channels …';
    if (name === 'channels …') return;
    const shown = new Set(view.channels);
    if (shown.has(name)) shown.delete(name);
    else shown.add(name);
    change({channels: [...shown].slice(-6)});
  }

  describe(state) {
    this.configuration = state.configuration;
    const names = ['channels …', ...state.channels];
    if (names.length !== this.add.options.length) {
      this.add.replaceChildren(...names.map((name) => make('option', {value: name}, label(name))));
    }
    // A machine of other columns: begin with its first two.
    if (state.channels.length && !view.channels.some((name) => state.channels.includes(name))) {
      change({channels: state.channels.slice(0, 2)});
    }
  }

  get pixels() {
    return Math.max(Math.round(this.panel.body.clientWidth), 16);
  }

  draw({channels, arrays}) {
    if (!channels.length || !arrays.t?.length) return;
    if (channels.join() !== this.names.join() || !this.chart) this.rebuild(channels);
    this.panel.filled();
    const scaled = [arrays.t.map((t) => t * 1000), ...channels.map((name) => arrays[name])];
    this.data = scaled;
    this.chart.set(scaled);
  }

  rebuild(channels = this.names) {
    this.chart?.remove();
    this.names = channels;
    const units = [...new Set(channels.map((name) => unitOf(name, this.configuration)))];
    const unitText = (unit) => channels.filter((name) => unitOf(name, this.configuration) === unit)
      .map(label).slice(0, 2).join(', ') + (unit ? ` [${unit}]` : '');
    this.chart = new Chart(this.panel.body, {
      xLabel: 'time [ms]',
      series: channels.map((name, index) => ({
        label: name, colour: lineColour(index), scale: unitOf(name, this.configuration) || 'y',
      })),
      axes: units.slice(0, 3).map((unit, index) => ({
        scale: unit || 'y', label: unitText(unit), side: index ? 1 : 3,
      })),
    });
    this.legend.replaceChildren(...channels.map((name, index) => {
      const item = make('span', {}, make('i'), `${label(name)} [${unitOf(name, this.configuration) || '?'}]`);
      item.firstChild.style.background = lineColour(index);
      return item;
    }));
  }
}
