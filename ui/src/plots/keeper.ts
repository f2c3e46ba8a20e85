// SPDX-License-Identifier: Apache-2.0
import { documentOf, type Panel } from './layout';
import { TimeRecorder } from './recorder';
import { follow, isSameState, noSamples, type Samples, type SampleState } from './samples';

/** The limit of all panels together, times included: some 32 MB, as browsers keep numbers. */
export const mostNumbers = 2e6;

/** The samples of one panel. */
export class Kept {
  readonly recorder: TimeRecorder;
  state: SampleState = noSamples;
  private readonly documents: string[];
  private readonly listeners = new Set<() => void>();
  private stop: (() => void) | null = null;
  private isOver = false;

  constructor(
    private readonly samples: Samples,
    readonly sources: string,
    panel: Panel,
    private readonly onSample: () => void,
  ) {
    this.recorder = new TimeRecorder(panel.sources);
    this.documents = [...new Set(panel.sources.map(documentOf))];
    this.pause(false);
  }

  /** Nothing is asked of the robot while it is paused; values from before and afterwards are not joined by lines. */
  pause(paused: boolean): void {
    if (this.isOver || paused === (this.stop === null)) return;
    if (!paused) {
      this.stop = follow(
        this.samples,
        this.documents,
        (document, time, sample) => {
          this.recorder.add(document, time, sample);
          this.onSample();
          this.tell();
        },
        (state) => {
          if (isSameState(this.state, state)) return;
          this.state = state;
          this.tell();
        },
      );
    } else {
      this.stop?.();
      this.stop = null;
      this.recorder.gap();
    }
  }

  /** Nothing is asked any more, whoever still shows the panel. */
  end(): void {
    this.pause(true);
    this.isOver = true;
  }

  /** Is told of samples, and of changes of the state, until the function that is returned is called. */
  onChange = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}

/** Keeps the samples of panels that plot over time, of the last ten minutes, whichever view the page shows. */
export class Keeper {
  private readonly all = new Map<number, Kept>();
  constructor(
    private readonly samples: Samples,
    private readonly most = mostNumbers,
  ) {}

  /** From now on the samples of these panels are kept, and those of others forgotten, also where a panel has other sources than before. */
  keep(panels: Panel[]): void {
    const wanted = new Map(panels.filter((panel) => panel.kind === 'time').map((panel) => [panel.id, panel]));
    for (const [id, kept] of this.all) {
      const panel = wanted.get(id);
      if (panel && JSON.stringify(panel.sources) === kept.sources) continue;
      kept.end();
      this.all.delete(id);
    }
    for (const [id, panel] of wanted)
      if (!this.all.has(id)) this.all.set(id, new Kept(this.samples, JSON.stringify(panel.sources), panel, () => this.limit()));
  }

  /** Undefined where that panel's samples are not kept. */
  of(id: number): Kept | undefined {
    return this.all.get(id);
  }

  /** Where all panels have too much, the one with the most forgets the older half. */
  private limit(): void {
    const recorders = [...this.all.values()].map((kept) => kept.recorder);
    if (recorders.reduce((sum, recorder) => sum + recorder.size, 0) <= this.most) return;
    recorders.reduce((most, one) => (one.size > most.size ? one : most)).halve();
  }
}
