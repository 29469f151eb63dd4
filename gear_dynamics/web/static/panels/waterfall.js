// Successive spectra over time or over speed, as colours in decibels.

import {mapColour, themeColour} from '../colours.js';
import {Panel, choice, make} from '../panel.js';
import {label, short} from '../units.js';
import {change, onChange, view} from '../view.js';

const ROWS = 120;
const COLUMNS = 512;
const DECADES = 4;
const MARGIN = {left: 70, bottom: 38, top: 6, right: 8};

export class Waterfall {
  constructor() {
    const mode = choice('against', ['time', 'speed'], view.waterfall,
      (text) => change({waterfall: text}));
    for (const option of mode.options) option.textContent = `over ${option.value}`;
    this.canvas = make('canvas');
    this.panel = new Panel('waterfall', 'Waterfall', {
      canvas: () => this.canvas,
      table: () => [['time', 'speed', ...this.axis], this.columns()],
      tools: [mode],
    });
    this.panel.body.append(this.canvas);
    this.rows = [];
    this.axis = [];
    onChange(() => {
      mode.value = view.waterfall;
      this.draw();
    });
    new ResizeObserver(() => this.draw()).observe(this.panel.body);
  }

  describe(state) {
    this.speed = state.latest.speed ?? NaN;
    if (state.rig !== this.rig) this.rows = [];
    this.rig = state.rig;
  }

  /** Keep the spectrum of the channel that the spectrum's panel shows, its peaks per column. */
  take(table) {
    if (table.name !== 'spectrum') return;
    const axis = table.arrays[table.axis];
    const values = table.arrays[view.spectrum];
    if (!values) return;
    if (this.channel !== view.spectrum || this.range !== view.range) this.rows = [];
    Object.assign(this, {channel: view.spectrum, range: view.range});
    const end = Math.min(view.range, axis.at(-1));
    const kept = new Float32Array(COLUMNS);
    for (let i = 0; i < axis.length && axis[i] <= end; i++) {
      const column = Math.min(Math.floor((axis[i] / end) * COLUMNS), COLUMNS - 1);
      kept[column] = Math.max(kept[column], values[i]);
    }
    this.end = end;
    this.axis = Array.from(kept, (_, i) => ((i + 0.5) * end) / COLUMNS);
    this.rows.push({time: performance.now() / 1000, speed: this.speed, values: kept});
    if (this.rows.length > ROWS) this.rows.shift();
    this.panel.filled();
    this.draw();
  }

  columns() {
    return [
      this.rows.map((row) => row.time), this.rows.map((row) => row.speed),
      ...this.axis.map((_, i) => this.rows.map((row) => row.values[i])),
    ];
  }

  draw() {
    const {canvas, rows} = this;
    const ratio = devicePixelRatio;
    const width = this.panel.body.clientWidth;
    const height = this.panel.body.clientHeight;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    canvas.style.width = `${width}px`;
    canvas.style.height = `${height}px`;
    if (!rows.length) return;
    const context = canvas.getContext('2d');
    context.scale(ratio, ratio);
    const [w, h] = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    const bySpeed = view.waterfall === 'speed';
    const now = rows.at(-1).time;
    const places = rows.map((row) => (bySpeed ? row.speed : row.time - now));
    let [low, high] = [Math.min(...places), Math.max(...places)];
    if (!(high > low)) [low, high] = [low - 1, high + 1];
    const highest = Math.max(...rows.map((row) => row.values.reduce((a, b) => Math.max(a, b), 0)));
    const y = (place) => MARGIN.top + h * (1 - (place - low) / (high - low));
    rows.forEach((row, index) => {
      const next = index + 1 < rows.length ? y(places[index + 1]) : y(places[index]);
      const top = bySpeed ? y(places[index]) - 2 : Math.min(y(places[index]), next);
      const size = bySpeed ? 4 : Math.max(Math.abs(y(places[index]) - next), h / ROWS, 1);
      this.drawRow(context, row.values, highest, MARGIN.left, top, w, size + 0.5);
    });
    this.drawAxes(context, {w, h, low, high, y, bySpeed});
  }

  drawRow(context, values, highest, left, top, width, height) {
    const strip = new ImageData(COLUMNS, 1);
    values.forEach((value, i) => {
      const share = 1 + Math.log10(Math.max(value / highest, 1e-30)) / DECADES;
      strip.data.set([...mapColour(share), 255], 4 * i);
    });
    this.strip ??= make('canvas', {width: COLUMNS, height: 1});
    this.strip.getContext('2d').putImageData(strip, 0, 0);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.strip, left, top, width, height);
  }

  drawAxes(context, {w, h, low, high, y, bySpeed}) {
    context.fillStyle = themeColour('faint');
    context.font = '12px system-ui, sans-serif';
    context.textAlign = 'center';
    for (let k = 0; k <= 4; k++) {
      context.textAlign = k === 4 ? 'right' : k === 0 ? 'left' : 'center';
      context.fillText(short((k * this.end) / 4), MARGIN.left + (k * w) / 4, MARGIN.top + h + 14);
    }
    context.textAlign = 'center';
    const legend = `; ${label(this.channel)}, ${20 * DECADES} dB from dark to bright`;
    context.fillText(`frequency [Hz]${w > 360 ? legend : ''}`, MARGIN.left + w / 2, MARGIN.top + h + 31);
    context.textAlign = 'right';
    for (const place of [low, (low + high) / 2, high]) {
      context.fillText(short(place), MARGIN.left - 5, Math.min(Math.max(y(place) + 4, 12), h + 4));
    }
    context.save();
    context.translate(12, MARGIN.top + h / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = 'center';
    context.fillText(bySpeed ? 'speed [rad/s]' : 'time [s]', 0, 0);
    context.restore();
  }
}
