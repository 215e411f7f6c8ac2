// The measurements of a scan that the server keeps, as far as whoever looks may change them.
import { errorText, fileNameOf, saveAs } from '../connection/api';
import {
  fetchMeasurements,
  fetchMeasurementsCsv,
  keepMeasurement,
  removeMeasurement,
  type KeptMeasurement,
  type Measured,
} from '../connection/measurements';
import { fetchAccess } from '../connection/scans';
import type { MeasuringEvent } from '../state/measuring';

export class KeptMeasurements {
  mayChange = false;

  // `tell` takes what the server answers; `allowed` is called when it is known who may change them.
  constructor(
    private readonly scanId: string,
    private readonly token: string,
    private readonly tell: (event: MeasuringEvent) => void,
    private readonly allowed: () => void,
  ) {}

  load(): void {
    fetchMeasurements(this.scanId, this.token).then(
      (kept) => this.tell({ kind: 'listed', kept }),
      this.fail,
    );
    fetchAccess(this.token).then(({ scan }) => {
      this.mayChange = scan;
      this.allowed();
    }, this.fail);
  }

  keep(name: string, measured: Measured): void {
    keepMeasurement(this.scanId, this.token, name, measured).then(
      (one) => this.tell({ kind: 'kept', one }),
      this.fail,
    );
  }

  remove({ id }: KeptMeasurement): void {
    removeMeasurement(this.scanId, this.token, id).then(
      () => this.tell({ kind: 'removed', id }),
      this.fail,
    );
  }

  // As a table, named after the scan.
  save(title: string): void {
    fetchMeasurementsCsv(this.scanId, this.token).then(
      (file) => saveAs(file, `${fileNameOf(title) || 'scan'}-measurements.csv`),
      this.fail,
    );
  }

  private readonly fail = (error: unknown): void =>
    this.tell({ kind: 'failed', message: errorText(error) });
}
