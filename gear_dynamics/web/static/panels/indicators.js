// A condition indicator over time.

import {Chart} from '../chart.js';
import {lineColour, themeColour} from '../colours.js';
import {Panel, choice, fill} from '../panel.js';
import {label} from '../units.js';
import {change, onChange, view} from '../view.js';

const MOST = 1200;

// Limits of an indicator come beside it, as NAME_warn and so on.
const LIMITS = ['warn', 'error', 'below_warn', 'below_error'];
const finite = (value) => (
  value === null || value === undefined || value === '' || !Number.isFinite(Number(value)) ? null : Number(value));
const isLimit = (name, values) => LIMITS.some(
  (limit) => name.endsWith(`_${limit}`) && name.slice(0, -limit.length - 1) in values);

export class Indicators {
  constructor() {
    this.name = choice('indicator', [view.indicator], view.indicator,
      (name) => change({indicator: name}));
    this.panel = new Panel('indicators', 'Indicator over time', {
      canvas: () => this.chart?.canvas,
      table: () => [['time', view.indicator, ...LIMITS], this.history.get(view.indicator) ?? []],
      tools: [this.name],
    });
    this.history = new Map();
    this.start = performance.now();
    onChange(() => {
      if (this.drawn !== view.indicator) this.rebuild();
    });
  }

  describe({rig, conditions}) {
    if (rig !== this.rig) this.history.clear();
    this.rig = rig;
    const now = (performance.now() - this.start) / 1000;
    for (const [subject, {values}] of Object.entries(conditions)) {
      for (const [name, value] of Object.entries(values)) {
        const number = finite(value);
        if (number === null || isLimit(name, values)) continue;
        const key = `${subject}/${name}`;
        if (!this.history.has(key)) this.history.set(key, [[], [], ...LIMITS.map(() => [])]);
        const row = [now, number, ...LIMITS.map((limit) => finite(values[`${name}_${limit}`]))];
        const columns = this.history.get(key);
        columns.forEach((column, index) => column.push(row[index]));
        if (columns[0].length > MOST) for (const column of columns) column.shift();
      }
    }
    const names = [...this.history.keys()].sort();
    if (!names.length) return;
    if (!names.includes(view.indicator)) names.push(view.indicator);
    fill(this.name, names, view.indicator);
    this.draw();
  }

  draw() {
    const data = this.history.get(view.indicator);
    if (!data?.[0].length) {
      this.panel.filled(`no value of ${label(view.indicator)} yet`);
      return;
    }
    if (!this.chart) this.rebuild();
    this.panel.filled();
    this.chart.set(data);
  }

  rebuild() {
    this.chart?.remove();
    this.drawn = view.indicator;
    this.chart = new Chart(this.panel.body, {
      xLabel: 'time [s]',
      series: [
        {label: view.indicator, colour: lineColour(2), scale: 'y'},
        ...LIMITS.map((limit) => ({
          label: limit, scale: 'y', dash: limit.endsWith('warn') ? [6, 4] : undefined,
          colour: themeColour(limit.endsWith('warn') ? 'warn' : 'error'),
        })),
      ],
      axes: [{scale: 'y', label: label(view.indicator), side: 3}],
    });
    const data = this.history.get(view.indicator);
    if (data) this.chart.set(data);
  }
}
