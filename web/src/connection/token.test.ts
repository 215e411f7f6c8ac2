import { describe, expect, it } from 'vitest';
import { readFragment, storedToken, storeToken } from './token';

describe('readFragment', () => {
  it('takes the token and leaves an address without it', () => {
    expect(readFragment('#token=abc123')).toEqual({ token: 'abc123', hash: '#/' });
    expect(readFragment('#token=a%2Bb&scan=s1')).toEqual({ token: 'a+b', hash: '#/scan/s1' });
  });

  it('takes a share link as a token that opens its scan', () => {
    expect(readFragment('#share=hms_1&scan=s1')).toEqual({ token: 'hms_1', hash: '#/scan/s1' });
    expect(readFragment('#share=')).toEqual({ token: null, hash: '#/' });
  });

  it('keeps how the scan is looked at', () => {
    expect(readFragment('#share=hms_1&scan=s1&clip=1,2&cut=%23%2F')).toEqual({
      token: 'hms_1',
      hash: '#/scan/s1?clip=1,2&cut=%23%2F',
    });
    expect(readFragment('#share=a&token=b&scan=s1').hash).toBe('#/scan/s1');
  });

  it('cleans the address even when the token is empty', () => {
    expect(readFragment('#token=')).toEqual({ token: null, hash: '#/' });
  });

  it('leaves other fragments alone', () => {
    for (const hash of ['', '#/', '#/scan/s1', '#/scan/token=x'])
      expect(readFragment(hash)).toEqual({ token: null, hash });
  });

  it('cannot be made to lead elsewhere by a strange scan', () => {
    expect(readFragment('#token=t&scan=..%2F..%23x').hash).toBe('#/scan/..%2F..%23x');
  });
});

describe('the stored token', () => {
  it('is trimmed, and empty when there is none', () => {
    const kept = new Map<string, string>();
    const storage = {
      getItem: (key: string) => kept.get(key) ?? null,
      setItem: (key: string, value: string) => void kept.set(key, value),
    };
    expect(storedToken(storage)).toBe('');
    storeToken(storage, ' abc\n');
    expect(storedToken(storage)).toBe('abc');
  });
});
