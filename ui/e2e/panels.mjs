// SPDX-License-Identifier: Apache-2.0
// Panels of the view Plots, and what canvases show.

/** Adds a panel with the fields of ports: {"drive.velocity": ["forward"]}. */
export async function addPanel(page, { words, fields, kind, title }) {
  await page.getByRole('button', { name: 'Add a panel' }).click();
  const dialog = page.getByRole('dialog', { name: 'Add a panel' });
  for (const [port, names] of Object.entries(fields)) {
    await dialog.getByLabel('Find ports').fill(words ?? port);
    await dialog.getByRole('button', { name: port }).click();
    for (const name of names) await dialog.getByLabel(name, { exact: false }).first().check();
  }
  if (kind) await dialog.getByRole('radio', { name: kind }).check();
  if (title) await dialog.getByLabel('Title').fill(title);
  await dialog.getByRole('button', { name: 'Add', exact: true }).click();
  await dialog.waitFor({ state: 'detached' });
}

/** Waits until a canvas has pixels of more than `most` colours. */
export async function drawn(canvas, most) {
  const handle = await canvas.elementHandle();
  await canvas.page().waitForFunction(
    ([place, least]) => {
      const { data } = place.getContext('2d').getImageData(0, 0, place.width, place.height);
      const colours = new Set();
      for (let at = 0; at < data.length; at += 4) colours.add((data[at] << 16) | (data[at + 1] << 8) | data[at + 2]);
      return colours.size > least;
    },
    [handle, most],
    { polling: 300 },
  );
}

/** Waits until a canvas has a pixel of about that colour. */
export async function coloured(canvas, colour) {
  const handle = await canvas.elementHandle();
  await canvas.page().waitForFunction(
    ([place, wanted]) => {
      const { data } = place.getContext('2d').getImageData(0, 0, place.width, place.height);
      for (let at = 0; at < data.length; at += 4) if (wanted.every((part, index) => Math.abs(data[at + index] - part) <= 12)) return true;
      return false;
    },
    [handle, colour],
    { polling: 300 },
  );
}
