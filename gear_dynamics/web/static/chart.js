// A line chart: uPlot with the page's look, that fits its panel and marks places on x.

import {themeColour} from './colours.js';
import {short} from './units.js';

export class Chart {
  /** `series`: {label, colour, scale, dash}; `axes`: {scale, label, side}; `log`: a logarithmic y. */
  constructor(body, {xLabel, series, axes, log = false, marks = () => []}) {
    this.body = body;
    const ink = themeColour('faint');
    const grid = {stroke: themeColour('line'), width: 1};
    const axis = {stroke: ink, grid, ticks: grid, font: '12px system-ui, sans-serif', labelFont: '12px system-ui, sans-serif', labelSize: 18};
    const scales = {x: {time: false}};
    for (const {scale} of axes) scales[scale] = log ? {distr: 3} : {};
    const values = (chart, ticks) => ticks.map((tick) => (tick === null ? '' : short(tick)));
    // A logarithmic axis has a line at each decade alone.
    const filter = (chart, ticks) => ticks.map(
      (tick) => (!log || Math.abs(Math.log10(tick) % 1) < 1e-9 ? tick : null));
    this.plot = new uPlot({
      width: body.clientWidth, height: body.clientHeight,
      scales,
      legend: {show: false},
      cursor: {drag: {x: true, y: false}},
      axes: [
        {...axis, label: xLabel, size: 34, values},
        ...axes.map(({scale, label, side}, index) => ({
          ...axis, scale, label, side, size: 58, values, filter,
          grid: index ? {show: false} : {...grid, filter}, ticks: {...grid, filter},
        })),
      ],
      series: [{}, ...series.map(({label, colour, scale, dash}) => ({
        label, stroke: colour, scale, dash, width: 1.2, points: {show: false},
      }))],
      hooks: {draw: [(chart) => this.mark(chart, marks())]},
    }, [[], ...series.map(() => [])], body);
    this.resize = new ResizeObserver(() => this.plot.setSize(
      {width: body.clientWidth, height: body.clientHeight}));
    this.resize.observe(body);
  }

  /** Draw dashed lines at places on x, each with a short text. */
  mark(chart, marks) {
    const {ctx, bbox} = chart;
    const {min, max} = chart.scales.x;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    let free = -Infinity;
    for (const {x, text, faint} of marks) {
      if (!(x >= min && x <= max)) continue;
      const place = chart.valToPos(x, 'x', true);
      ctx.strokeStyle = themeColour('faint');
      ctx.globalAlpha = faint ? 0.35 : 0.7;
      ctx.setLineDash([4 * devicePixelRatio, 4 * devicePixelRatio]);
      ctx.beginPath();
      ctx.moveTo(place, bbox.top);
      ctx.lineTo(place, bbox.top + bbox.height);
      ctx.stroke();
      const width = ctx.measureText(text).width;
      if (text && place - width / 2 > free) {
        ctx.globalAlpha = 1;
        ctx.fillStyle = themeColour('faint');
        ctx.textAlign = 'center';
        ctx.fillText(text, place, bbox.top + 10 * devicePixelRatio);
        free = place + width / 2 + 6 * devicePixelRatio;
      }
    }
    ctx.restore();
  }

  set(data, range) {
    this.plot.setData(data, !range);
    if (range) this.plot.setScale('x', {min: range[0], max: range[1]});
  }

  get canvas() {
    return this.plot.ctx.canvas;
  }

  remove() {
    this.resize.disconnect();
    this.plot.destroy();
  }
}
