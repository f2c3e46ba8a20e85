// SPDX-License-Identifier: Apache-2.0
import { lazy, Suspense, useEffect, useState } from 'react';
import { EventsView } from './events/EventsView';
import { clockText, isInTrouble, stateText } from './health/health';
import { HealthBanner } from './health/HealthBanner';
import { HaltBanner, StopButton } from './halt/StopButton';
import { isTyping } from './keys';
import { KeysHelp } from './KeysHelp';
import { MissionsView } from './missions/MissionsView';
import { NetworkView } from './network/NetworkView';
import { PastView } from './past/PastView';
import { PlotsView } from './plots/PlotsView';
import { PlotsContext, usePlotsOf } from './plots/usePlots';
import { useConnection, useDocument, useLink } from './robot/hooks';
import { Skipped } from './robot/Skipped';
import { statusOf, type Status } from './robot/types';
import { hasRos2 } from './ros2/ros2';
import { Ros2View } from './ros2/Ros2View';
import { SwitchView } from './switch/SwitchView';

const EditView = lazy(() => import('./edit/EditView').then((part) => ({ default: part.EditView }))); // the editor is large

const views = ['Network', 'Switch', 'Missions', 'Plots', 'Events', 'Edit', 'Past', 'ROS 2'] as const;
type View = (typeof views)[number];

/** "ros2" */
const inAddress = (view: View) => view.toLowerCase().replace(' ', '');

function viewOfAddress(): View {
  const name = window.location.hash.split('/')[0]; // what follows is for the view itself
  return views.find((view) => '#' + inAddress(view) === name) ?? 'Network';
}

/** The view that the address names; keys choose another one, or the field to search in. */
function useView(): View {
  const [view, setView] = useState<View>(viewOfAddress);
  useEffect(() => {
    const follow = () => setView(viewOfAddress());
    const press = (event: KeyboardEvent) => {
      if (isTyping(event) || event.ctrlKey || event.metaKey || event.altKey) return;
      const chosen = views[Number(event.key) - 1];
      if (chosen) window.location.hash = inAddress(chosen);
      if (event.key === '/') {
        event.preventDefault();
        document.querySelector<HTMLInputElement>('[data-search]')?.focus();
      }
    };
    window.addEventListener('hashchange', follow);
    window.addEventListener('keydown', press);
    return () => {
      window.removeEventListener('hashchange', follow);
      window.removeEventListener('keydown', press);
    };
  }, []);
  return view;
}

/** The robot's state as the page knows it. */
interface Known {
  status: Status | null;
  /** The page shows an old state: nobody hears the robot, or another runtime commands it. */
  isOld: boolean;
  skipped: number | undefined;
  /** Why the robot cannot be reached. */
  error: string | undefined;
  /** A sentence about when the status was heard, or nothing. */
  since: string;
}

function useKnown(): Known {
  const link = useLink();
  const shown = useDocument('status');
  const status = statusOf(shown?.value);
  const isOld = status !== null && (link === 'lost' || link === 'refused' || shown?.error !== undefined);
  const since = shown?.heard === undefined ? '' : ' What is shown is of ' + clockText(shown.heard) + '.';
  return { status, isOld, skipped: shown?.skipped, error: shown?.error, since };
}

function Top({ view, known: { status, isOld, skipped } }: { view: View; known: Known }) {
  const connection = useConnection();
  const isShown = (name: View) => name !== 'ROS 2' || name === view || connection.hasRos2 || hasRos2(status);
  return (
    <header className="top">
      <h1>{connection.robot || 'Segue Studio'}</h1>
      <nav aria-label="Views">
        {views.filter(isShown).map((name, index) => (
          <a key={name} href={'#' + inAddress(name)} aria-current={view === name ? 'page' : undefined} title={'Key ' + (index + 1)}>
            {name}
          </a>
        ))}
      </nav>
      {status && (
        <p className={isOld ? 'old' : undefined}>
          {status.controller || 'the empty network'}, <span className={isInTrouble(status) ? 'bad' : undefined}>{isOld ? 'unknown' : stateText(status)}</span>
          <Skipped count={skipped} />
          {connection.role === 'observe' && <span className="badge">observe only</span>}
        </p>
      )}
      <KeysHelp />
      {status && <StopButton status={status} />}
    </header>
  );
}

/** Why what is shown may be old. */
function LinkBanner({ known: { error, since } }: { known: Known }) {
  const link = useLink();
  if (link === 'refused') return <p className="banner" role="alert">The studio does not know this browser (any more). Open the address that it has printed last.</p>;
  if (link === 'lost') return <p className="banner" role="alert">The studio cannot be reached; trying again …{since}</p>;
  if (link === 'open' && error) return <p className="banner" role="alert">The robot cannot be reached: {error}.{since}</p>;
  return null;
}

/** Views that show something before the robot has been heard. */
const viewsWithoutStatus: View[] = ['Missions', 'Events', 'Edit'];

function Shown({ view, known: { status, isOld, error } }: { view: View; known: Known }) {
  const link = useLink();
  return (
    <main className={isOld || status?.lost != null ? 'old' : undefined}>
      {!status && !viewsWithoutStatus.includes(view) && link !== 'refused' && !error && <p className="empty">Waiting for the robot …</p>}
      {status && view === 'Network' && <NetworkView status={status} />}
      {status && view === 'Switch' && <SwitchView status={status} />}
      {view === 'Missions' && <MissionsView />}
      {status && view === 'Plots' && <PlotsView status={status} />}
      {view === 'Events' && <EventsView />}
      {view === 'Past' && status && <PastView />}
      {status && view === 'ROS 2' && <Ros2View status={status} />}
      {view === 'Edit' && <Suspense fallback={<p className="empty">…</p>}><EditView /></Suspense>}
    </main>
  );
}

export function App() {
  const view = useView();
  const known = useKnown();
  const plots = usePlotsOf(useConnection().robot);
  const { status, isOld } = known;
  return (
    <PlotsContext value={plots}>
      <Top view={view} known={known} />
      {status && <HaltBanner status={status} />}
      {status && !isOld && <HealthBanner status={status} />}
      <LinkBanner known={known} />
      <Shown view={view} known={known} />
    </PlotsContext>
  );
}
