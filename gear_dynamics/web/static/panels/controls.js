// The knobs: each publishes a real command or sets a real parameter.

import {choice, fill, make} from '../panel.js';

const KNOBS = {
  speed: {text: 'speed [rad/s]', low: 0, high: 1500, step: 0.5},
  load_torque: {text: 'load torque [N m]', low: 0, high: 600, step: 1},
  friction_coefficient: {text: 'friction coefficient', low: 0, high: 0.2, step: 0.001},
};

export class Controls {
  constructor(connection) {
    this.connection = connection;
    this.element = document.getElementById('controls');
    this.knobs = {};
  }

  /** Build the controls, once the server has said what there is. */
  build({presets, faultKinds}) {
    const send = (command) => this.connection.command(command);
    this.preset = choice('machine', ['choose a machine …', ...presets], 'choose a machine …',
      (name) => presets.includes(name) && send({command: 'preset', name}));
    this.preset.id = 'preset';
    const machine = make('fieldset', {}, make('legend', {}, 'Machine'),
      make('div', {className: 'row'}, this.preset),
      make('div', {className: 'row'},
        this.button('pause', () => send({command: 'pause', held: true})),
        this.button('run', () => send({command: 'pause', held: false})),
        this.button('reset', () => send({command: 'reset'}))));
    const operation = make('fieldset', {}, make('legend', {}, 'Operation'),
      ...Object.keys(KNOBS).map((name) => this.knob(name)));
    this.notices = make('ul', {id: 'notices'});
    this.locked = make('p', {className: 'small', hidden: true}, 'A recorded log: nothing to steer.');
    this.element.replaceChildren(this.locked, machine, operation,
      ...(faultKinds.length ? [this.faults(faultKinds)] : []),
      make('fieldset', {}, make('legend', {}, 'What happened'), this.notices));
  }

  button(text, onclick) {
    return make('button', {type: 'button', id: `do-${text}`, onclick}, text);
  }

  knob(name) {
    const {text, low, high, step} = KNOBS[name];
    const range = make('input', {type: 'range', min: low, max: high, step, id: `range-${name}`, 'aria-label': text});
    const number = make('input', {type: 'number', step: 'any', id: `number-${name}`, 'aria-label': text});
    const send = (value) => {
      this.knobs[name].touched = performance.now();
      range.value = number.value = value;
      this.connection.command({command: 'set', name, value: Number(value)});
    };
    range.addEventListener('input', () => (number.value = range.value));
    range.addEventListener('change', () => send(range.value));
    number.addEventListener('change', () => send(number.value));
    this.knobs[name] = {range, number, touched: -Infinity};
    return make('div', {className: 'knob'}, make('span', {}, text), number, range);
  }

  faults(kinds) {
    const kind = choice('fault', kinds, kinds[0], () => {});
    kind.id = 'fault-kind';
    const wheel = choice('wheel', ['pinion', 'gear'], 'gear', () => {});
    wheel.id = 'fault-wheel';
    const tooth = make('input', {type: 'number', id: 'fault-tooth', min: 0, step: 1, value: 17, title: 'tooth; empty for all'});
    const severity = make('input', {type: 'range', id: 'fault-severity', min: 0, max: 1, step: 0.01, value: 0});
    const shown = make('span', {}, '0');
    severity.addEventListener('input', () => (shown.textContent = severity.value));
    const send = () => this.connection.command({
      command: 'fault', kind: kind.value, wheel: wheel.value,
      tooth: tooth.value === '' ? null : Number(tooth.value), severity: Number(severity.value),
    });
    severity.addEventListener('change', send);
    return make('fieldset', {}, make('legend', {}, 'Faults'),
      make('div', {className: 'row'}, kind),
      make('div', {className: 'row'}, wheel, make('label', {}, 'tooth ', tooth)),
      make('div', {className: 'knob'}, make('span', {}, 'severity'), shown, severity));
  }

  describe(state) {
    if (!this.preset) return;
    this.locked.hidden = state.controllable;
    for (const element of this.element.querySelectorAll('input, select, button')) {
      element.disabled = !state.controllable;
    }
    const parameters = state.configuration.parameters ?? {};
    for (const [name, knob] of Object.entries(this.knobs)) {
      // What a hand has just set is not taken back by a state that is older.
      const held = document.activeElement === knob.number || document.activeElement === knob.range;
      if (parameters[name] === undefined || (held && performance.now() - knob.touched < 5000)) continue;
      if (performance.now() - knob.touched < 1000) continue;
      knob.range.value = parameters[name];
      knob.number.value = Number(Number(parameters[name]).toPrecision(6));
    }
    this.notices.replaceChildren(
      ...state.notices.slice(-6).reverse().map((line) => make('li', {}, line)));
  }
}
