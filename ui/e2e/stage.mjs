// SPDX-License-Identifier: Apache-2.0
// What tests in a browser have in common: a robot in a folder of its own, its studio, and a page of it. Ends with status 77
// where there is no browser.
import { spawn, execFileSync } from 'node:child_process';
import { mkdtempSync, mkdirSync, rmSync, readFileSync, existsSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import assert from 'node:assert/strict';
import { chromium } from 'playwright-core';

/** Where Chromium is; without it the program ends with status 77. */
export function browserProgram() {
  const program = ['/usr/bin/chromium', '/usr/bin/chromium-browser'].find(existsSync);
  if (program) return program;
  console.log('skipped: chromium is not installed (tools/setup --test)');
  process.exit(77);
}

/** Ends a program by Ctrl-C; resolves to its exit status. */
export function end(child) {
  const ended = new Promise((resolve) => child.on('exit', (status) => resolve(status)));
  child.kill('SIGINT');
  return ended;
}

/** Ends a program and, with it, the processes of its robot; the program alone where it does not. */
async function ended(child) {
  if (child.exitCode !== null || child.signalCode !== null) return;
  const stubborn = setTimeout(() => child.kill('SIGKILL'), 20000);
  await end(child);
  clearTimeout(stubborn);
}

const patience = 120000; // ms: a busy machine draws slowly

export class Stage {
  constructor(segue, pictures) {
    this.browserProgram = browserProgram();
    this.segue = segue;
    this.pictures = pictures;
    this.folder = mkdtempSync(join(tmpdir(), 'segue-studio-'));
    // Tests that run at the same time do not see each other in ROS 2, as a rule, nor the pages of the manual, which have 70 to 89.
    const ros2 = { ROS_DOMAIN_ID: String(20 + (process.pid % 50)), ROS_LOCALHOST_ONLY: '1' };
    this.environment = { ...process.env, ...ros2, XDG_RUNTIME_DIR: join(this.folder, 'run'), XDG_STATE_HOME: join(this.folder, 'state') };
    this.running = [];
    this.problems = [];
    this.axe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
    mkdirSync(pictures, { recursive: true });
    mkdirSync(join(this.folder, 'run'), { mode: 0o700 });
  }

  run(args) {
    return execFileSync(this.segue, args, { cwd: this.folder, env: this.environment, encoding: 'utf8' });
  }

  /** Starts a program that ends with the test. */
  launch(program, args) {
    const child = spawn(program, args, { cwd: this.folder, env: this.environment });
    this.running.push(child);
    return child;
  }

  /** Starts `segue`, and waits for a line that fits. */
  start(args, fits) {
    const child = this.launch(this.segue, args);
    return new Promise((resolve, reject) => {
      let output = '';
      const take = (data) => {
        output += data;
        const found = fits.exec(output);
        if (found) resolve({ child, found: found[0] });
      };
      child.stdout.on('data', take);
      child.stderr.on('data', take);
      child.on('exit', () => reject(new Error(args.join(' ') + ' ended: ' + output)));
    });
  }

  startStudio(...options) {
    return this.start(['studio', '--port', '0', ...options], /http:\/\/127\.0\.0\.1:\d+\/\?token=[0-9a-f]{64}/);
  }

  /** Waits until the robot runs that controller, and nothing is in progress. */
  async settled(controller) {
    for (const deadline = Date.now() + 60000; Date.now() < deadline; await new Promise((resolve) => setTimeout(resolve, 50))) {
      const status = JSON.parse(this.run(['status', '--format', 'json']));
      if (status.controller === controller && status.requests.length === 0) return;
    }
    assert.fail('the robot does not run ' + controller);
  }

  /** Waits until the graph of the page is laid out for the room that it has now; what is at the pointer afterwards stays there. */
  async laidOut(page) {
    // Observers of sizes report in the frame after the one in which something opened or closed.
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
    await page.locator('.graph[aria-busy=false]').waitFor();
  }

  /** The page of a studio beside the robot that runs. */
  async openPage() {
    this.studio = await this.startStudio();
    return this.openBrowser();
  }

  /** openPage(), and comes in. */
  async enter() {
    const page = await this.openPage();
    await page.goto(this.studio.found);
    await page.waitForURL((address) => !address.search.includes('token'));
    return page;
  }

  /** A test in a page beside the robot in that file, whose components may be stand-ins; both end with it. '': it runs no controller. */
  async beside(robotFile, controller, test) {
    const robot = await this.start(['run', '--stand-in', robotFile, ...(controller ? ['--controller', controller] : [])], /robot \w+ runs/);
    if (controller) await this.settled(controller);
    await test(await this.enter());
    await this.browser.close();
    await end(this.studio.child);
    await end(robot.child);
  }

  /** A whole test: what is thrown, and problems of pages, make it fail; everything that was started ends. */
  async play(test) {
    let failed = false;
    try {
      await test();
      assert.deepEqual(this.problems, []);
      console.log('passed; screenshots are in ' + this.pictures);
    } catch (error) {
      failed = true;
      console.error(error);
      process.exitCode = 1;
    } finally {
      await this.close(failed);
    }
  }

  /** An empty page of a browser with these `options` of its own; what goes wrong in the page is in `problems`. */
  async openBrowser(...options) {
    this.browser = await chromium.launchPersistentContext(join(this.folder, 'browser'), {
      executablePath: this.browserProgram,
      headless: true,
      viewport: { width: 1360, height: 820 },
      args: ['--no-sandbox', '--disable-gpu', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', ...options],
    });
    this.browser.setDefaultTimeout(patience);
    return this.watched(this.browser.pages()[0] ?? (await this.browser.newPage()));
  }

  /** Another visitor with the same browser, without what it has been given. */
  async visitor(options) {
    const context = await this.browser.browser().newContext(options);
    context.setDefaultTimeout(patience);
    return context;
  }

  /** The page, whose problems are those of the test from now on. */
  watched(page) {
    page.on('pageerror', (error) => this.problems.push(String(error)));
    page.on('console', (message) => /Content Security Policy/.test(message.text()) && this.problems.push(message.text()));
    return page;
  }

  /** Takes a picture, and looks for violations of accessibility. */
  async capture(page, name) {
    await page.screenshot({ path: join(this.pictures, name + '.png') });
    await page.evaluate(this.axe);
    const found = await page.evaluate(() => window.axe.run());
    const violations = found.violations.map((one) => one.id + ': ' + one.nodes.map((node) => node.html.slice(0, 160)).join(' | '));
    assert.deepEqual(violations, [], 'accessibility of ' + name);
  }

  async close(failed) {
    const page = this.browser?.pages()[0];
    if (failed) await page?.screenshot({ path: join(this.pictures, 'failed.png') }).catch(() => {});
    await this.browser?.close();
    for (const child of this.running.reverse()) await ended(child);
    rmSync(this.folder, { recursive: true, force: true });
  }
}
