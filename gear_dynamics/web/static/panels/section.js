// The Poincaré section, growing live: one point a mesh cycle.

import {lineColour, themeColour} from '../colours.js';
import {Panel, make} from '../panel.js';
import {short} from '../units.js';

const MOST = 20000;
const FITTED = 1000; // the latest points, by which the axes are chosen
const MARGIN = {left: 78, bottom: 38, top: 8, right: 10};

export class Section {
  constructor() {
    this.canvas = make('canvas');
    this.count = make('span', {className: 'small'});
    const clear = make('button', {type: 'button', className: 'small', title: 'Begin anew',
      onclick: () => this.clear()}, 'clear');
    this.panel = new Panel('section', 'Poincaré section', {
      canvas: () => this.canvas,
      table: () => [['x', 'y'], [this.x, this.y]],
      tools: [this.count, clear],
    });
    this.panel.body.append(this.canvas);
    this.clear();
    new ResizeObserver(() => this.redraw()).observe(this.panel.body);
  }

  clear() {
    this.x = [];
    this.y = [];
    this.limits = null;
    this.redraw();
  }

  describe(state) {
    if (state.rig !== this.rig) this.clear();
    this.rig = state.rig;
  }

  take({arrays, cleared}) {
    if (cleared) this.clear();
    const first = this.x.length;
    for (let i = 0; i < arrays.x.length; i++) {
      this.x.push(arrays.x[i]);
      this.y.push(arrays.y[i]);
    }
    this.count.textContent = `${this.x.length} points`;
    this.sinceFit += arrays.x.length;
    if (this.x.length > 1.2 * MOST) {
      this.x.splice(0, this.x.length - MOST);
      this.y.splice(0, this.y.length - MOST);
      this.redraw();
    } else if (this.fits(first) && this.sinceFit < FITTED) this.points(first);
    else this.redraw();
  }

  /** Return whether the points from an index on lie within the drawn limits. */
  fits(first) {
    if (!this.limits) return false;
    const {left, right, low, high} = this.limits;
    for (let i = first; i < this.x.length; i++) {
      if (this.x[i] < left || this.x[i] > right || this.y[i] < low || this.y[i] > high) return false;
    }
    return true;
  }

  fit() {
    const extent = (values) => {
      const [low, high] = values.reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
      // Points that coincide but for rounding shall look like one.
      const half = Math.max(0.6 * (high - low), 1e-3 * Math.max(Math.abs(low), Math.abs(high)), 1e-6);
      return [(low + high) / 2 - half, (low + high) / 2 + half];
    };
    const [left, right] = extent(this.x.slice(-FITTED));
    const [low, high] = extent(this.y.slice(-FITTED));
    this.limits = {left, right, low, high};
    this.sinceFit = 0;
  }

  redraw() {
    const {canvas} = this;
    const ratio = devicePixelRatio;
    this.width = this.panel.body.clientWidth;
    this.height = this.panel.body.clientHeight;
    canvas.width = this.width * ratio;
    canvas.height = this.height * ratio;
    canvas.style.width = `${this.width}px`;
    canvas.style.height = `${this.height}px`;
    this.panel.filled(this.x.length ? '' : 'waiting for points of the section');
    if (!this.x.length) return;
    this.fit();
    this.context = canvas.getContext('2d');
    this.context.scale(ratio, ratio);
    this.axes();
    this.points(0);
  }

  place(x, y) {
    const {left, right, low, high} = this.limits;
    return [
      MARGIN.left + ((x - left) / (right - left)) * (this.width - MARGIN.left - MARGIN.right),
      MARGIN.top + ((high - y) / (high - low)) * (this.height - MARGIN.top - MARGIN.bottom),
    ];
  }

  points(first) {
    const {context} = this;
    context.fillStyle = lineColour(0);
    const {left, right, low, high} = this.limits;
    for (let i = first; i < this.x.length; i++) {
      // Older points, of another motion, may lie outside.
      if (this.x[i] < left || this.x[i] > right || this.y[i] < low || this.y[i] > high) continue;
      const [x, y] = this.place(this.x[i], this.y[i]);
      context.fillRect(x - 1, y - 1, 2.4, 2.4);
    }
  }

  axes() {
    const {context, width, height, limits} = this;
    const [w, h] = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    context.strokeStyle = themeColour('line');
    context.strokeRect(MARGIN.left, MARGIN.top, w, h);
    context.fillStyle = themeColour('faint');
    context.font = '12px system-ui, sans-serif';
    for (const share of [0, 0.5, 1]) {
      context.textAlign = ['left', 'center', 'right'][2 * share];
      const x = limits.left + share * (limits.right - limits.left);
      context.fillText(short(x), MARGIN.left + share * w, height - MARGIN.bottom + 15);
      context.textAlign = 'right';
      const y = limits.high - share * (limits.high - limits.low);
      context.fillText(short(y), MARGIN.left - 5, MARGIN.top + share * h + (share ? 2 : 10));
    }
    context.textAlign = 'center';
    context.fillText('δ / b', MARGIN.left + w / 2, height - 5);
    context.save();
    context.translate(12, MARGIN.top + h / 2);
    context.rotate(-Math.PI / 2);
    context.fillText('δ′ / (b ωn)', 0, 0);
    context.restore();
  }
}
