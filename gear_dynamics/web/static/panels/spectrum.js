// A spectrum over frequency or order, with the lines that the machine explains marked.

import {Chart} from '../chart.js';
import {lineColour} from '../colours.js';
import {Panel, choice, fill} from '../panel.js';
import {label, unitOf} from '../units.js';
import {change, onChange, view} from '../view.js';

const HARMONICS = 12;

/** Mesh harmonics, sidebands of the shafts and bearing orders, in orders of the pinion's shaft. */
export function marks(configuration, span) {
  const {pinion_teeth: z1, gear_teeth: z2} = configuration?.parameters ?? {};
  const found = [];
  if (z1) {
    for (let k = 1; k <= HARMONICS; k++) found.push({x: k * z1, text: k === 1 ? 'mesh' : `${k}×`});
    // Sidebands only where there is room to tell them apart.
    if (span < 3 * z1) {
      for (let k = 1; k <= 3; k++) {
        for (const shaft of [1, z1 / z2]) {
          for (const side of [-1, 1]) found.push({x: k * z1 + side * shaft, text: '', faint: true});
        }
      }
    }
  }
  for (const [name, bearing] of Object.entries(configuration?.machine?.bearings ?? {})) {
    for (const [part, order] of Object.entries(bearing.orders ?? {})) {
      found.push({x: order, text: `${name} ${part}`, faint: true});
    }
  }
  return found.sort((a, b) => a.x - b.x);
}

export class Spectrum {
  /** `kind` is 'spectrum' or 'orders'; `table` the name of the table it draws. */
  constructor(kind, {title, table, xLabel, range, ranges}) {
    Object.assign(this, {kind, xLabel, range, tableName: table});
    this.channel = choice('channel', [view[kind]], view[kind], (name) => change({[kind]: name}));
    const scale = choice('amplitude scale', ['log', 'linear'], view.scale,
      (text) => change({scale: text}));
    const span = choice('range', ranges.map(String), String(view[range]),
      (text) => change({[range]: Number(text)}));
    for (const option of span.options) option.textContent = `to ${option.value}`;
    this.panel = new Panel(kind, title, {
      canvas: () => this.chart?.canvas,
      table: () => [[this.axis, view[kind]], this.data ?? []],
      tools: [this.channel, span, scale],
    });
    onChange(() => {
      scale.value = view.scale;
      span.value = String(view[range]);
      this.rebuild();
    });
  }

  describe(state) {
    this.state = state;
  }

  take(table) {
    if (table.name !== this.tableName) return;
    this.latest = table;
    const names = Object.keys(table.arrays).filter((name) => name !== table.axis && name !== 'duration');
    if (!names.includes(view[this.kind])) change({[this.kind]: names[0]});
    fill(this.channel, names, view[this.kind]);
    this.draw();
  }

  draw() {
    if (!this.latest) return;
    if (!this.chart) this.rebuild();
    const {arrays, axis} = this.latest;
    this.axis = axis;
    const values = arrays[view[this.kind]];
    if (!values) return;
    const log = view.scale === 'log';
    const highest = values.reduce((a, b) => Math.max(a, b), 0);
    // A logarithm has no place for 0: seven decades below the highest line are drawn.
    const drawn = log ? values.map((value) => Math.max(value, highest * 1e-7, 1e-30)) : values;
    this.data = [arrays[axis], drawn];
    this.panel.filled();
    this.chart.set(this.data, [0, Math.min(view[this.range], arrays[axis].at(-1))]);
  }

  rebuild() {
    this.chart?.remove();
    const configuration = this.state?.configuration;
    const unit = unitOf(view[this.kind], configuration);
    this.chart = new Chart(this.panel.body, {
      xLabel: this.xLabel,
      log: view.scale === 'log',
      series: [{label: view[this.kind], colour: lineColour(0), scale: 'y'}],
      axes: [{scale: 'y', label: `${label(view[this.kind])} [${unit || '?'}]`, side: 3}],
      marks: () => this.marks(),
    });
    this.chartOf = view[this.kind];
    this.draw();
  }

  marks() {
    const {configuration, latest} = this.state ?? {};
    const speed = latest?.speed;
    const perOrder = this.kind === 'orders' ? 1 : speed / (2 * Math.PI);
    if (!(perOrder > 0)) return [];
    return marks(configuration, view[this.range] / perOrder)
      .map((mark) => ({...mark, x: mark.x * perOrder}));
  }
}
