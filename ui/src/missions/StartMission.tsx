// SPDX-License-Identifier: Apache-2.0
import { useEffect, useId, useState, type FormEvent } from 'react';
import { ActionButton } from '../ActionButton';
import { ListPane } from '../panes/Panel';
import { reason } from '../reason';
import type { Json } from '../robot/change';
import { useConnection } from '../robot/hooks';
import type { Run } from './run';
import { defaultText, givenInputs, missionsIn, modes, problemsOf, startedOf, type MissionForm, type MissionInput, type Mode } from './start';

interface Asked<Answer> {
  answer: Answer | null;
  problem: string;
}

/** The answer to a question of the page; asked anew where it changes, and nothing is asked where it is null. */
function useQuestion<Answer>(verb: string | null, path: string, read: (answer: Json) => Answer): Asked<Answer> {
  const connection = useConnection();
  const [asked, setAsked] = useState<Asked<Answer>>({ answer: null, problem: '' });
  useEffect(() => {
    setAsked({ answer: null, problem: '' });
    if (verb === null) return;
    let current = true;
    connection.call(verb, path === '' ? {} : { path }).then(
      (answer) => current && setAsked({ answer: read(answer), problem: '' }),
      (error: unknown) => current && setAsked({ answer: null, problem: reason(error) }),
    );
    return () => {
      current = false;
    };
  }, [connection, verb, path, read]);
  return asked;
}

const asForm = (answer: Json) => answer as unknown as MissionForm;

interface FieldProps {
  input: MissionInput;
  text: string | undefined;
  problem: string | undefined;
  onType: (text: string) => void;
}

/** An input of the mission by its type. */
function InputField({ input, text, problem, onType }: FieldProps) {
  const id = useId();
  const byDefault = defaultText(input);
  const value = text ?? byDefault;
  const common = {
    id, value, spellCheck: false, className: text === undefined ? undefined : 'edited', 'aria-invalid': problem !== undefined,
    'aria-describedby': problem === undefined ? id + '-type' : id + '-problem ' + id + '-type',
    onChange: (event: { target: { value: string } }) => onType(event.target.value),
  };
  const isLong = ['list', 'map', 'any'].includes(input.type) || !['text', 'int', 'float', 'bool'].includes(input.type);
  return (
    <div className="mission-input" data-input={input.name}>
      <label htmlFor={id}>{input.name}</label> <small id={id + '-type'} className="quiet">{input.type}{isLong ? ', as in YAML' : ''}{text === undefined || byDefault === '' ? '' : '; by default ' + byDefault}</small>
      {input.type === 'bool' ? (
        <select {...common}>
          {byDefault === '' && <option value="">no value</option>}
          <option value="true">true</option>
          <option value="false">false</option>
        </select>
      ) : isLong ? (
        <textarea rows={Math.min(8, value.split('\n').length + 1)} {...common} />
      ) : (
        <input inputMode={input.type === 'int' ? 'numeric' : input.type === 'float' ? 'decimal' : 'text'} {...common} />
      )}
      {problem !== undefined && <output id={id + '-problem'} className="bad">{problem}</output>}
    </div>
  );
}

interface How {
  mode: Mode;
  simulate: boolean;
  stepsBack: boolean;
}

/** How the mission runs, and where. */
function HowFields({ how, onHow }: { how: How; onHow: (how: How) => void }) {
  const id = useId();
  return (
    <>
      <label htmlFor={id}>Mode</label>
      <select id={id} value={how.mode} aria-describedby={id + '-means'} onChange={(event) => onHow({ ...how, mode: event.target.value as Mode })}>
        {modes.map(({ mode, label }) => <option key={mode} value={mode}>{label}</option>)}
      </select>
      <p id={id + '-means'} className="quiet means">{modes.find((one) => one.mode === how.mode)?.means}</p>
      <fieldset>
        <legend>Where</legend>
        <label><input type="radio" name={id} checked={!how.simulate} onChange={() => onHow({ ...how, simulate: false })} /> on the robot</label>
        <label><input type="radio" name={id} checked={how.simulate} onChange={() => onHow({ ...how, simulate: true })} /> simulated, at once and without the robot</label>
      </fieldset>
      {how.mode === 'sequential' && !how.simulate && (
        <label className="choice"><input type="checkbox" checked={how.stepsBack} onChange={(event) => onHow({ ...how, stepsBack: event.target.checked })} /> keep what is needed to step back</label>
      )}
    </>
  );
}

interface FormProps {
  path: string;
  form: MissionForm;
  onBegun: () => void;
  onSimulated: (run: Run) => void;
}

/** The form of one mission. */
function FormOf({ path, form, onBegun, onSimulated }: FormProps) {
  const connection = useConnection();
  const [typed, setTyped] = useState<Record<string, string>>({});
  const [how, setHow] = useState<How>({ mode: 'sequential', simulate: false, stepsBack: false });
  const [problems, setProblems] = useState<Record<string, string>>({});
  const [refusal, setRefusal] = useState('');
  const [isAsked, setAsked] = useState(false);
  const type = (name: string, text: string) => {
    setTyped({ ...typed, [name]: text });
    setProblems(({ [name]: _, ...others }) => others);
  };
  const submit = async (event: FormEvent) => {
    event.preventDefault();
    const found = problemsOf(form, typed);
    setProblems(found);
    setRefusal('');
    if (Object.keys(found).length > 0) return;
    setAsked(true);
    try {
      const { mode, simulate, stepsBack } = how;
      const started = startedOf(await connection.call('start_mission', { path, inputs: givenInputs(form, typed), mode, simulate, steps_back: mode === 'sequential' && !simulate && stepsBack }));
      if (started === 'begun') onBegun();
      else if ('simulated' in started) onSimulated(started.simulated);
      else setProblems(started.problems);
    } catch (error) {
      setRefusal(reason(error));
    }
    setAsked(false);
  };
  return (
    <form noValidate onSubmit={(event) => void submit(event)}>
      {form.description && <p className="quiet">{form.description}</p>}
      {form.inputs.map((input) => (
        <InputField key={input.name} input={input} text={typed[input.name]} problem={problems[input.name]} onType={(text) => type(input.name, text)} />
      ))}
      {form.inputs.length === 0 && <p className="quiet">It has no inputs.</p>}
      <HowFields how={how} onHow={setHow} />
      <ActionButton type="submit" className="primary" whyNot={isAsked ? 'asked; the answer is under way' : ''}>{how.simulate ? 'Simulate' : 'Start'}</ActionButton>
      {refusal && <p className="bad" role="alert">{refusal}</p>}
    </form>
  );
}

const isOnlyOne = (paths: string[] | null) => (paths?.length === 1 ? (paths[0] ?? '') : '');

/** The pane in which a mission of the robot's folder is chosen, its inputs are filled, and it is started. */
export function StartMission({ onBegun, onSimulated }: { onBegun: () => void; onSimulated: (run: Run) => void }) {
  const id = useId();
  const [chosen, setChosen] = useState('');
  const { answer: paths, problem } = useQuestion('files', '', missionsIn);
  const path = chosen || isOnlyOne(paths);
  const { answer: form, problem: faulty } = useQuestion(path === '' ? null : 'mission_form', path, asForm);
  return (
    <ListPane label="Start a mission">
      <h2>Start a mission</h2>
      <div className="start-mission">
        <label htmlFor={id}>Mission</label>
        <select id={id} value={path} onChange={(event) => setChosen(event.target.value)}>
          {path === '' && <option value="">choose one …</option>}
          {paths?.map((one) => <option key={one}>{one}</option>)}
        </select>
        {problem && <p className="bad" role="alert">{problem}</p>}
        {paths?.length === 0 && <p className="quiet">There is no mission in the folder of the robot. <a href="#edit">Edit</a> makes one.</p>}
        {faulty && <p className="bad" role="alert">{faulty}</p>}
        {form && <FormOf key={path} path={path} form={form} onBegun={onBegun} onSimulated={onSimulated} />}
      </div>
    </ListPane>
  );
}
