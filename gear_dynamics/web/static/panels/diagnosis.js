// What the monitor says: a line a subject, the worst first.

import {Panel, make} from '../panel.js';
import {label} from '../units.js';

const WORDS = ['ok', 'warning', 'alarm'];

export class Diagnosis {
  constructor() {
    this.panel = new Panel('diagnosis', 'Diagnosis', {});
    this.table = make('table');
    this.panel.body.append(this.table);
  }

  describe({conditions, faults}) {
    const rows = Object.entries(conditions)
      .filter(([, {message}]) => message)
      .sort(([a, x], [b, y]) => y.level - x.level || a.localeCompare(b))
      .map(([subject, {level, message}]) => make('tr', {},
        make('td', {className: `level${Math.min(level, 2)}`}, WORDS[level] ?? 'stale'),
        make('td', {}, label(subject)), make('td', {}, message)));
    const truth = faults.map((fault) => make('tr', {},
      make('td', {}, 'truth'), make('td', {}, label(String(fault.fault ?? ''))),
      make('td', {}, `${fault.wheel} ${fault.tooth === '' ? '' : `tooth ${fault.tooth}`} severity ${fault.severity}`)));
    this.panel.filled(rows.length + truth.length ? '' : 'no result yet');
    this.table.replaceChildren(...truth, ...rows);
  }
}
