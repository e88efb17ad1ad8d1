// The list of layouts: pick one, save what is shown under a name, and which plots are shown.

export class LayoutMenu {
  // plots: [{key, title}]; shown(): what is shown now; apply(layout); say(text): what went wrong.
  constructor(element, layouts, plots, { shown, apply, say }) {
    Object.assign(this, { element, layouts, plots, shown, apply, say });
    const part = (name) => element.querySelector(name);
    this.list = part('#layout_list');
    this.name = part('#layout_name');
    this.choice = part('#layout_plots');
    part('#layout_form').addEventListener('submit', (event) => {
      event.preventDefault();
      this.save();
    });
    element.addEventListener('toggle', () => { if (element.open) this.fill(); });
    document.addEventListener('pointerdown', (event) => { if (!element.contains(event.target)) element.open = false; });
    element.addEventListener('keydown', (event) => { if (event.key === 'Escape') element.open = false; });
  }

  save() {
    const name = this.name.value.trim();
    if (!name) return;
    try {
      this.layouts.put(name, this.shown());
      this.name.value = '';
    } catch (error) {
      this.say(`layout '${name}': ${error.message}`);
    }
    this.fill();
  }

  fill() {
    const button = (text, title, call) => {
      const made = Object.assign(document.createElement('button'), { type: 'button', textContent: text, title });
      made.addEventListener('click', call);
      return made;
    };
    this.list.replaceChildren(...this.layouts.names().map((name) => {
      const row = document.createElement('li');
      const remove = button('\u00d7', `forget ${name}`, () => {
        this.layouts.remove(name);
        this.fill();
      });
      remove.setAttribute('aria-label', `forget ${name}`);
      row.append(button(name, 'show it', () => {
        this.apply(this.layouts.get(name));
        this.element.open = false;
      }), remove);
      return row;
    }));
    if (this.list.childElementCount === 0) this.list.append(Object.assign(document.createElement('li'), { className: 'empty', textContent: 'none saved' }));
    this.choice.replaceChildren(...this.plots.map(({ key, title }) => {
      const label = document.createElement('label');
      const box = Object.assign(document.createElement('input'), { type: 'checkbox', checked: !this.shown().hide.includes(key) });
      box.addEventListener('change', () => {
        const hide = this.shown().hide.filter((other) => other !== key);
        this.apply({ ...this.shown(), hide: box.checked ? hide : [...hide, key] });
      });
      label.append(box, ` ${title}`);
      return label;
    }));
  }
}
