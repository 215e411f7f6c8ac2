// Recordings, clouds and meshes on their way to being scans: what waits, what is done with it, what
// failed and why; and the way to add one.
import { errorText } from '../connection/api';
import { cancelJob, fetchJobs, retryJob, type Job } from '../connection/jobs';
import { browserWorld, sendRecording, unfinishedUploads } from '../connection/upload';
import { jobText, sendingText, unfinishedText } from '../state/text';
import { t } from '../texts/texts';
import { buttonOf, element, type Panel } from './dom';
import { statusMark } from './mark';
import { noticeLine } from './notice';

const shown_count = 20;

// Of the panel that is on the page: what is sent goes on while another page is looked at.
let sayOnPage = (_text: string): void => {};

export interface JobsPanel extends Panel {
  readonly failed: HTMLElement; // jobs that came to nothing, for the end of the page
  allow(on: boolean): void; // whether whoever looks may send anything
  refresh(): Promise<void>;
}

// `changed` is called when something was done that shows in the list.
export function jobsPanel(token: () => string, changed: () => void): JobsPanel {
  const lists = jobLists(
    (job) => rowOf(job, token, attempt),
    (failures) =>
      attempt(async () => {
        for (const job of failures) await cancelJob(job.id, token());
      }),
  );
  const { element: notice, say } = noticeLine();
  const input = element('input', {
    type: 'file',
    multiple: true,
    id: 'recordings',
    class: 'hidden-input',
  });
  const add = element('label', { for: 'recordings', class: 'button' }, t.addARecordingCloudOrMesh);
  const node = element(
    'section',
    { class: 'jobs-panel', 'aria-label': t.recordings },
    element('div', { class: 'field' }, input, add),
    notice,
    lists.going,
  );
  const world = browserWorld();
  let allowed = false;
  node.hidden = true;

  sayOnPage = say;
  const sayUnfinished = (): void => sayOnPage(unfinishedText(unfinishedUploads(world)));
  const attempt = async (work: () => Promise<void>): Promise<void> => {
    try {
      await work();
      sayUnfinished();
    } catch (error) {
      sayOnPage(errorText(error));
    }
    changed();
  };
  const send = (files: Iterable<File>): Promise<void> =>
    attempt(async () => {
      for (const file of files)
        await sendRecording(file, token(), world, (progress) =>
          sayOnPage(sendingText(file.name, progress)),
        );
    });
  sayUnfinished();
  input.addEventListener(
    'change',
    () => void send([...(input.files ?? [])]).finally(() => (input.value = '')),
  );
  const stopDrops = onDrops((files) => void (allowed && send(files)));
  return {
    element: node,
    failed: lists.failed,
    allow(on) {
      allowed = on;
      node.hidden = !on;
      if (!on) lists.clear();
    },
    async refresh() {
      if (allowed) lists.show(await fetchJobs(token()));
    },
    dispose: stopDrops,
  };
}

// What waits or is worked at, and what has failed. Written only when something differs.
function jobLists(
  rowFor: (job: Job) => HTMLElement,
  dismiss: (jobs: readonly Job[]) => Promise<void>,
) {
  const going = element('ul', { class: 'scans jobs' });
  let shown = '';
  let failures: readonly Job[] = [];
  const failed = failedSection(() => dismiss(failures));
  return {
    going,
    failed: failed.element,
    show(jobs: readonly Job[]): void {
      const key = JSON.stringify(jobs);
      if (key === shown) return;
      shown = key;
      failures = jobs.filter((job) => job.state === 'failed').slice(0, shown_count);
      const unfinished = jobs
        .filter((job) => job.state === 'queued' || job.state === 'running')
        .slice(0, shown_count);
      going.replaceChildren(...unfinished.map((job) => element('li', {}, rowFor(job))));
      failed.show(failures.map(rowFor));
    },
    clear(): void {
      shown = '';
      failed.show([]);
    },
  };
}

// Anywhere on the page: a file that is dropped beside the panel would replace
// it. Returns how to stop.
function onDrops(take: (files: File[]) => void): () => void {
  const onDrag = (event: DragEvent): void => event.preventDefault();
  const onDrop = (event: DragEvent): void => {
    event.preventDefault();
    take([...(event.dataTransfer?.files ?? [])]);
  };
  document.addEventListener('dragover', onDrag);
  document.addEventListener('drop', onDrop);
  return () => {
    document.removeEventListener('dragover', onDrag);
    document.removeEventListener('drop', onDrop);
  };
}

function failedSection(dismissThem: () => Promise<void>): {
  readonly element: HTMLElement;
  show(rows: readonly HTMLElement[]): void;
} {
  const list = element('ul', { class: 'scans' });
  const dismissAll = buttonOf(t.dismissAll);
  const node = element(
    'section',
    { class: 'failed-jobs', 'aria-label': t.failed },
    element('div', { class: 'failed-head' }, element('h2', {}, t.failed), dismissAll),
    list,
  );
  node.hidden = true;
  dismissAll.addEventListener('click', () => void dismissThem());
  return {
    element: node,
    show(rows) {
      list.replaceChildren(...rows.map((row) => element('li', {}, row)));
      node.hidden = rows.length === 0;
      dismissAll.hidden = rows.length < 2;
    },
  };
}

function rowOf(
  job: Job,
  token: () => string,
  attempt: (work: () => Promise<void>) => Promise<void>,
): HTMLElement {
  const mark = statusMark();
  mark.show(jobText(job));
  const actionOf = (
    label: string,
    work: (id: string, token: string) => Promise<void>,
  ): HTMLElement => {
    const button = buttonOf(label, { 'aria-label': `${label}: ${job.title}` });
    button.addEventListener('click', () => void attempt(() => work(job.id, token())));
    return button;
  };
  const buttons =
    job.state === 'failed'
      ? [actionOf(t.tryAgain, retryJob), actionOf(t.dismiss, cancelJob)]
      : [actionOf(t.cancel, cancelJob)];
  const progress =
    job.total > 0
      ? element('progress', {
          max: job.total,
          value: job.done,
          class: 'facts',
          'aria-label': t.progressOf(job.title),
        })
      : null;
  return element(
    'div',
    { class: 'scan-row' },
    element('span', { class: 'scan-title' }, job.title),
    mark.element,
    progress,
    job.words ? element('span', { class: 'facts words' }, job.words) : null,
    element('span', { class: 'row-buttons' }, ...buttons),
  );
}
