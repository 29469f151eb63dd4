// The frame of a panel: its title, its own controls, its picture and its data.

/** Make an element with attributes and children. */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (name in element) element[name] = value;
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** Make a choice among texts; `take` is called with the chosen one. */
export function choice(title, texts, chosen, take) {
  const select = make('select', {title, 'aria-label': title});
  fill(select, texts, chosen);
  select.addEventListener('change', () => take(select.value));
  return select;
}

/** Replace the texts of a choice, if they are others. */
export function fill(select, texts, chosen) {
  const now = [...select.options].map((option) => option.value).join('\n');
  if (now !== texts.join('\n')) {
    select.replaceChildren(
      ...texts.map((text) => make('option', {value: text}, text.replaceAll('_', ' '))));
  }
  if (texts.includes(chosen)) select.value = chosen;
}

function save(name, blob) {
  const link = make('a', {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export class Panel {
  /** `canvas()` gives the picture, `table()` the data as [names, columns]. */
  constructor(id, title, {canvas, table, tools = []}) {
    this.element = document.getElementById(id);
    this.body = make('div', {className: 'body'});
    this.empty = make('div', {className: 'empty'}, 'waiting for data');
    this.body.append(this.empty);
    this.title = make('h2', {}, title);
    const buttons = [];
    if (canvas) buttons.push(this.button('PNG', 'Save as a picture', () => this.picture(canvas())));
    if (table) buttons.push(this.button('CSV', 'Save the data', () => this.data(...table())));
    this.element.append(
      make('div', {className: 'head'}, this.title, ...tools, ...buttons), this.body);
    this.id = id;
  }

  button(text, title, onclick) {
    return make('button', {type: 'button', className: 'small', title, onclick}, text);
  }

  filled(text = '') {
    this.empty.hidden = !text;
    this.empty.style.display = text ? '' : 'none';
    this.empty.textContent = text;
  }

  picture(source) {
    if (!source) return;
    const ratio = source.width / source.clientWidth || 1;
    const head = Math.round(26 * ratio);
    const canvas = make('canvas', {width: source.width, height: source.height + head});
    const context = canvas.getContext('2d');
    const style = getComputedStyle(this.element);
    context.fillStyle = style.backgroundColor;
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.fillStyle = style.color;
    context.font = `600 ${Math.round(14 * ratio)}px system-ui, sans-serif`;
    context.fillText(this.title.textContent, 8 * ratio, 18 * ratio);
    context.drawImage(source, 0, head);
    canvas.toBlob((blob) => save(`${this.id}.png`, blob));
  }

  data(names, columns) {
    if (!columns.length) return;
    const rows = [names.join(',')];
    for (let i = 0; i < columns[0].length; i++) rows.push(columns.map((c) => c[i]).join(','));
    save(`${this.id}.csv`, new Blob([`${rows.join('\n')}\n`], {type: 'text/csv'}));
  }
}
