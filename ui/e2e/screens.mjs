// SPDX-License-Identifier: Apache-2.0
// What is shown, on small and large screens and a tablet.

const sizes = [{ width: 1280, height: 800 }, { width: 1920, height: 1080 }, { width: 820, height: 1180 }];
const leastText = 11;

/** What is too small to be read, or lies outside of the page or of what it is in. */
function faultsIn(least) {
  const faults = [];
  if (document.documentElement.scrollWidth > window.innerWidth) faults.push('the page is ' + document.documentElement.scrollWidth + ' px wide');
  const named = (one) => one.tagName.toLowerCase() + ' "' + (one.getAttribute('aria-label') ?? one.textContent).trim().slice(0, 40) + '"';
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (node.data.trim() === '' || !parent.checkVisibility({ visibilityProperty: true }) || parent.closest('.hidden, script, style, .cm-gutters, canvas')) continue;
    const viewport = parent.closest('.react-flow__viewport');
    const zoom = viewport ? new DOMMatrix(getComputedStyle(viewport).transform).a : 1;
    const size = parseFloat(getComputedStyle(parent).fontSize) * zoom;
    if (size < least - 0.05) faults.push(size.toFixed(1) + ' px: ' + named(parent));
  }
  const clips = (one) => one === document.body || getComputedStyle(one).overflowX !== 'visible';
  for (const control of document.querySelectorAll('button, a[href], input, select, textarea')) {
    if (!control.checkVisibility({ visibilityProperty: true }) || control.closest('.graph, .cm-editor, .hidden') || control.matches('[type=file]')) continue;
    let around = control.parentElement;
    while (!clips(around)) around = around.parentElement;
    const [inner, outer] = [control.getBoundingClientRect(), around.getBoundingClientRect()];
    if (inner.right > outer.right + 1 || inner.left < outer.left - 1) faults.push(named(control) + ' sticks out of ' + (around.className || around.tagName));
  }
  return [...new Set(faults)];
}

/** Looks at what is shown, on all screens; a graph gets its place a moment after the screen has its size. Resolves to what is wrong. */
export async function lookAt(stage, page, name) {
  if (await page.locator('.graph').count()) await page.locator('.react-flow__node').first().waitFor();
  const problems = [];
  for (const size of sizes) {
    await page.setViewportSize(size);
    let faults = null;
    for (const deadline = Date.now() + 20000; Date.now() < deadline && faults?.length !== 0; await new Promise((resolve) => setTimeout(resolve, 100))) {
      faults = await page.evaluate(faultsIn, leastText);
    }
    const where = `view_${name}_${size.width}`;
    await stage.capture(page, where).catch((error) => faults.push(error.message));
    problems.push(...faults.slice(0, 5).map((fault) => where + ': ' + fault));
    console.log(where + ': ' + (faults.join('; ') || 'good'));
  }
  return problems;
}
