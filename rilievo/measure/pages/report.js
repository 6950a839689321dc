'use strict';
// One slider for all pictures, captions, and the cursors in the plots.
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const slider = document.getElementById('slider');
  const play = document.getElementById('play');
  const label = document.getElementById('frame');
  const plots = [...document.querySelectorAll('svg.plot')];
  const frames = document.getElementById('frames');
  const cards = [];

  function addCard(title, pictures, captions, holdsTruth, before = null) {
    const figure = document.createElement('figure');
    const image = new Image(data.size[0], data.size[1]);
    const caption = document.createElement('figcaption');
    const name = document.createElement('strong');
    const small = document.createElement('small');
    name.textContent = title;
    image.alt = title;
    image.draggable = false;
    caption.append(name, small);
    figure.append(image, caption);
    frames.insertBefore(figure, before);
    const card = { title, image, name, small, pictures, captions, held: false };
    cards.push(card);
    if (!holdsTruth) return;
    figure.className = 'hold';
    const hold = (held) => () => { card.held = held; show(); };
    image.addEventListener('pointerdown', hold(true));
    for (const end of ['pointerup', 'pointerleave', 'pointercancel'])
      image.addEventListener(end, hold(false));
  }

  function show() {
    const at = Number(slider.value);
    const frame = data.shown[at];
    label.textContent = `frame ${frame}`;
    for (const card of cards) {
      card.image.src = card.held ? data.truth[at] : card.pictures[at];
      card.name.textContent = card.held ? 'True frame' : card.title;
      card.small.textContent = card.captions ? card.captions[at] : '';
    }
    for (const plot of plots) {
      const { left, right, xMin, xMax } = plot.dataset;
      const t = (frame - xMin) / (xMax - xMin);
      const x = Number(left) + t * (right - left);
      const cursor = plot.querySelector('.cursor');
      cursor.setAttribute('x1', x);
      cursor.setAttribute('x2', x);
    }
  }

  // A click into a plot goes to the nearest frame shown.
  function seek(plot, event) {
    const box = plot.getScreenCTM().inverse();
    const x = new DOMPoint(event.clientX, event.clientY).matrixTransform(box).x;
    const { left, right, xMin, xMax } = plot.dataset;
    const frame = Number(xMin) + (x - left) / (right - left) * (xMax - xMin);
    let best = 0;
    data.shown.forEach((shown, i) => {
      if (Math.abs(shown - frame) < Math.abs(data.shown[best] - frame)) best = i;
    });
    slider.value = best;
    show();
  }

  addCard('True frame', data.truth, null, false, frames.firstElementChild);
  for (const method of data.methods) {
    addCard(method.name, method.pictures, method.captions, true);
    addCard(`${method.name}: difference`, method.differences, null, false);
  }
  for (const plot of plots) {
    plot.style.cursor = 'crosshair';
    plot.addEventListener('click', (event) => seek(plot, event));
  }

  let timer = null;
  play.addEventListener('click', () => {
    if (timer) {
      clearInterval(timer);
      timer = null;
    } else {
      timer = setInterval(() => {
        slider.value = (Number(slider.value) + 1) % data.shown.length;
        show();
      }, 120);
    }
    play.textContent = timer ? 'Pause' : 'Play';
  });
  slider.max = data.shown.length - 1;
  slider.addEventListener('input', show);
  if (data.shown.length > 0) show();
})();
