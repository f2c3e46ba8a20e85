// SPDX-License-Identifier: Apache-2.0
import { useEffect, useMemo, useState } from 'react';
import { ActionButton } from '../ActionButton';
import { Splitter } from '../panes/Splitter';
import type { Range } from '../plots/chart';
import type { Panel } from '../plots/layout';
import type { Drawn } from '../plots/recorder';
import { usePlots } from '../plots/usePlots';
import { phasesOf, type Film } from './film';
import { FilmChart } from './FilmChart';
import { beginOf, windowOf, zoomedTo, type Clock } from './film_samples';
import { sliderSteps, timeText } from './slider';
import { useClock } from './usePast';
import '../plots/plots.css';

/** How often, in ms, samples are taken over while they still come. */
const period = 250;
/** How late, in seconds, samples may come from the robot. */
const latest = 2;

interface PanelSamples {
  panel: Panel;
  drawn: Drawn;
}

/** The kept samples of the film's time, by panels that have any. They stay as long as the film is open. Null: not known yet. */
function useFilmSamples(film: Film, clock: Clock | null): PanelSamples[] | null {
  const { panels, keeper } = usePlots();
  const [found, setFound] = useState<PanelSamples[] | null>(null);
  useEffect(() => {
    if (!clock) return undefined;
    const begin = beginOf(film, clock);
    const [from, to] = windowOf(film);
    const samplesOf = (panel: Panel) => keeper.of(panel.id)?.recorder.between(begin + from, begin + to, begin) ?? { labels: [], data: [[]] };
    const read = () => setFound(panels.map((panel) => ({ panel, drawn: samplesOf(panel) as Drawn })).filter(({ drawn }) => drawn.labels.length > 0));
    read();
    const asked = performance.now();
    const isPast = () => clock.studio_s + (performance.now() - asked) / 1000 > begin + to + latest;
    if (isPast()) return undefined;
    const timer = setInterval(() => {
      read();
      if (isPast()) clearInterval(timer);
    }, period);
    return () => clearInterval(timer);
  }, [film, clock, panels, keeper]);
  return found;
}

/** Which plots have no samples of the film's time, and how well times agree. */
function Notes({ found, clock }: { found: PanelSamples[]; clock: Clock }) {
  const { panels } = usePlots();
  const without = panels.filter((panel) => panel.kind === 'time' && !found.some((one) => one.panel.id === panel.id));
  return (
    <p className="panel-notes">
      <span>Samples stand where the studio read them, up to some 50 ms after they were written (large ones: more); the film may be off from them by {timeText(clock.within_s, clock.within_s)}.</span>
      {without.length > 0 && <span>No samples of this time: {without.map((panel) => panel.title).join(', ')}.</span>}
    </p>
  );
}

interface Props {
  film: Film;
  at: number;
  onTime: (time: number) => void;
}

function Charts({ film, at, onTime, found, clock }: Props & { found: PanelSamples[]; clock: Clock }) {
  const whole = useMemo(() => windowOf(film), [film]);
  const phases = useMemo(() => phasesOf(film), [film]);
  const [zoom, setZoom] = useState<Range | null>(null);
  const range = zoom ?? whole;
  const zoomBy = (factor: number) => setZoom(zoomedTo(range, factor, at, whole));
  const moveTo = (time: number) => onTime(Math.min(film.length, Math.max(0, time)));
  const press = (key: string) => {
    if (key === 'ArrowLeft') moveTo(at - film.length / sliderSteps);
    else if (key === 'ArrowRight') moveTo(at + film.length / sliderSteps);
    else if (key === '+') zoomBy(0.5);
    else if (key === '-') zoomBy(2);
    else return false;
    return true;
  };
  return (
    <>
      <Splitter name="film" label="Height of the plots" axis="y" sized="after" />
      <section className="film-charts" aria-label="Plots of this time" tabIndex={0}>
        <div className="panel-tools">
          <button type="button" className="small" aria-label="Zoom in" onClick={() => zoomBy(0.5)}>+</button>
          <button type="button" className="small" aria-label="Zoom out" onClick={() => zoomBy(2)}>−</button>
          <ActionButton type="button" className="small" tip whyNot={zoom ? '' : 'all is shown'} onClick={() => setZoom(null)}>All</ActionButton>
          <ul className="plain phases" aria-label="Phases of the transition">
            {phases.map(({ phase, from, to }) => <li key={phase}><i className={'phase-' + phase} /> {phase} <span className="quiet">{timeText(to - from, to - from)}</span></li>)}
          </ul>
        </div>
        <div className="film-chart-list">
          {found.map(({ panel, drawn }) => (
            <FilmChart key={panel.id} title={panel.title} drawn={drawn} phases={phases} at={at} range={range} onTime={moveTo} onZoom={setZoom} onAll={() => setZoom(null)} onKey={press} />
          ))}
        </div>
        <Notes found={found} clock={clock} />
      </section>
    </>
  );
}

/** The user's plots over the time of a film, as far as this page has kept their samples. */
export function FilmCharts({ film, at, onTime }: Props) {
  const { clock, problem } = useClock();
  const found = useFilmSamples(film, clock);
  if (problem !== null) return <p className="film-note bad" role="status">No plots beside this film, since the robot does not tell its clock: {problem}</p>;
  if (!clock || !found) return null;
  if (found.length > 0) return <Charts film={film} at={at} onTime={onTime} found={found} clock={clock} />;
  return (
    <p className="film-note quiet" role="status">
      No plots of this time: samples are kept from when a port is plotted over time, while this page is open. <a href="#plots">Plot a port</a>
    </p>
  );
}
