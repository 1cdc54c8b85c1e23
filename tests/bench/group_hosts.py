#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""Measures a group of bpa-server on hosts that are network namespaces of this machine.

    group_hosts.py scale  --library DIR --bop DATASET [--workers 1 2 4] [--share 0.25]
    group_hosts.py faults --library DIR --bop DATASET [--times 20]
    group_hosts.py discovery --library DIR [--times 10]

A bridge of its own joins the namespaces; no packet leaves them. `--share` is how much of a processor
each worker gets (cgroup v1, cpu.cfs_quota_us). Needs root, `ip` and `tc`. Prints Markdown tables.
"""
import argparse
import contextlib
import json
import math
import os
import pathlib
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

PROGRAMS = pathlib.Path(__file__).resolve().parents[2] / 'build' / 'release' / 'bin'
PREFIX = f'bpa{os.getpid() % 10000}'
CGROUPS = pathlib.Path('/sys/fs/cgroup/cpu')
PERIOD_US = 100000


def sh(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


class Hosts:
    """Namespaces 0 to count - 1, with addresses 10.77.0.1 and so on."""

    def __init__(self, count):
        self.count = count
        sh('ip', 'netns', 'add', f'{PREFIX}n')
        self.in_net('ip', 'link', 'add', 'name', 'br0', 'type', 'bridge')
        self.in_net('ip', 'link', 'set', 'br0', 'up')
        for host in range(count):
            name = self.name(host)
            sh('ip', 'netns', 'add', name)
            self.in_net('ip', 'link', 'add', f'p{host}', 'type', 'veth', 'peer', 'name', 'eth0',
                        'netns', name)
            self.in_net('ip', 'link', 'set', f'p{host}', 'master', 'br0', 'up')
            for command in (['addr', 'add', f'10.77.0.{host + 1}/24', 'dev', 'eth0'],
                            ['link', 'set', 'eth0', 'up'], ['link', 'set', 'lo', 'up'],
                            ['route', 'add', '224.0.0.0/4', 'dev', 'eth0']):
                sh('ip', '-n', name, *command)

    @staticmethod
    def name(host):
        return f'{PREFIX}h{host}'

    @staticmethod
    def in_net(*command):
        sh('ip', 'netns', 'exec', f'{PREFIX}n', *command)

    def link(self, host, up):
        self.in_net('ip', 'link', 'set', f'p{host}', 'up' if up else 'down')

    def slow(self, host, rate):
        """Of both directions, such as 20mbit; empty: as fast as it is."""
        how = ['root', 'tbf', 'rate', rate, 'burst', '64kb', 'latency', '400ms'] if rate else ['root']
        verb = 'add' if rate else 'del'
        self.in_net('tc', 'qdisc', verb, 'dev', f'p{host}', *how)
        sh('ip', 'netns', 'exec', self.name(host), 'tc', 'qdisc', verb, 'dev', 'eth0', *how)

    def sent_bytes(self, host):
        out = subprocess.run(['ip', '-j', '-s', '-n', self.name(host), 'link', 'show', 'eth0'],
                             check=True, capture_output=True, text=True).stdout
        return json.loads(out)[0]['stats64']['tx']['bytes']

    def close(self):
        for name in [self.name(host) for host in range(self.count)] + [f'{PREFIX}n']:
            subprocess.run(['ip', 'netns', 'del', name], check=False)


def held_by(pid):
    status = pathlib.Path(f'/proc/{pid}/status').read_text(encoding='utf-8')
    values = dict(line.split(':\t', 1) for line in status.splitlines() if ':\t' in line)
    descriptors = len(list(pathlib.Path(f'/proc/{pid}/fd').iterdir()))
    return f'{descriptors}, {values["Threads"].strip()}, {int(values["VmRSS"].split()[0]) // 1024}'


class Group:
    def __init__(self, hosts, folder, options):
        self.hosts, self.folder = hosts, folder
        self.library, self.share, self.programs = folder / 'library', options.share, options.programs
        shutil.copytree(options.library, self.library)
        self.processes = {}
        self.environment = {key: value for key, value in os.environ.items() if not key.startswith('ROS_')}

    def start(self, name, host, *arguments):
        environment = self.environment
        command = ['ip', 'netns', 'exec', self.hosts.name(host), self.programs / 'bpa-server',
                   '--set', 'network.range=subnet', '--set', 'detection.follow=false', *arguments]
        log = open(self.folder / f'{name}.log', 'a', encoding='utf-8')
        self.processes[name] = subprocess.Popen(command, stdout=log, stderr=log, env=environment)
        return self.processes[name]

    def front(self, name='front', host=0, *arguments):
        return self.start(name, host, '--role', 'front', '--library', self.library, '--threads', '1',
                          *arguments)

    def worker(self, number, *arguments):
        """On host `number`, from 1."""
        process = self.start(f'worker{number}', number, '--role', 'worker', '--threads', '1', '--set',
                             f'group.cache={self.folder}/cache{number}', *arguments)
        return process

    def limit(self):
        """Gives each worker its share of a processor."""
        for name, process in self.processes.items():
            if self.share and name.startswith('worker'):
                group = CGROUPS / f'{PREFIX}{name}'
                group.mkdir(exist_ok=True)
                (group / 'cpu.cfs_period_us').write_text(str(PERIOD_US))
                (group / 'cpu.cfs_quota_us').write_text(str(int(self.share * PERIOD_US)))
                (group / 'cgroup.procs').write_text(str(process.pid))

    def client(self, *arguments, timeout=600):
        return subprocess.run(['ip', 'netns', 'exec', self.hosts.name(0), self.programs / 'bpa-client', *arguments],
                              capture_output=True, text=True, timeout=timeout, env=self.environment, check=False)

    def begin(self, *arguments):
        """A client that runs."""
        return subprocess.Popen(['ip', 'netns', 'exec', self.hosts.name(0), self.programs / 'bpa-client',
                                 *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                env=self.environment)

    def ready(self):
        out = self.client('--timeout', '20', 'status').stdout
        return sum(': ' not in line and 'ready' in line
                   for line in out.splitlines() if line.strip().startswith('worker'))

    def wait_for(self, workers):
        end = time.monotonic() + 300
        while self.ready() != workers:
            if time.monotonic() > end:
                print(self.client('status').stdout, file=sys.stderr)
                for log in sorted(self.folder.glob('*.log')):
                    print(log.name, log.read_text(encoding='utf-8')[-2000:], sep='\n', file=sys.stderr)
                raise SystemExit(f'{workers} workers did not come')
            time.sleep(0.2)

    def held(self):
        """What those hold that no fault ends."""
        return ' and '.join(held_by(self.processes[name].pid) for name in ('front', 'worker1'))

    def log(self, name):
        return (self.folder / f'{name}.log').read_text(encoding='utf-8')

    def stop(self, name):
        process = self.processes.pop(name)
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGCONT)
        process.kill()
        process.wait()

    def close(self):
        for name in list(self.processes):
            self.stop(name)
        for group in CGROUPS.glob(f'{PREFIX}worker*'):
            with contextlib.suppress(OSError):
                group.rmdir()


def frames_of(path):
    return json.loads(path.read_text(encoding='utf-8'))['frames']


def detect(group, options, *more):
    path = group.folder / 'answer.json'
    path.unlink(missing_ok=True)
    began = time.monotonic()
    out = group.client('detect', '--bop', options.bop, '--json', path, '--wait', '240', *more)
    took = time.monotonic() - began
    return (frames_of(path) if path.exists() else None), took, out.stdout + out.stderr


@contextlib.contextmanager
def cell(options, hosts):
    network = Hosts(hosts)
    with tempfile.TemporaryDirectory() as folder:
        group = Group(network, pathlib.Path(folder), options)
        try:
            yield network, group
        finally:
            group.close()
            network.close()


def scale(options):
    print('| workers | seconds a frame (median) | of one worker | efficiency | MB sent by the front a frame '
          f'| found | false | frames a minute of {options.clients} clients at once '
          '| seconds to fetch and load the models |\n|---|---|---|---|---|---|---|---|---|')
    first = None
    for workers in options.workers:
        with cell(options, workers + 1) as (hosts, group):
            group.front()
            for number in range(1, workers + 1):
                group.worker(number)
            began = time.monotonic()
            group.wait_for(workers)
            fetched = time.monotonic() - began
            group.limit()
            one = ['--scenes', options.scene]
            warm = detect(group, options, *one)[0]  # paces are measured
            before = hosts.sent_bytes(0)
            frames, _, text = detect(group, options)
            if frames is None:
                raise SystemExit(text)
            sent = (hosts.sent_bytes(0) - before) / len(frames) / 1e6
            began = time.monotonic()
            clients = [group.begin('detect', '--bop', options.bop, '--wait', '240', *one)
                       for _ in range(options.clients)]
            for client in clients:
                client.communicate(timeout=600)
            rate = 60 * len(warm) * options.clients / (time.monotonic() - began)
        seconds = statistics.median(frame['seconds'] for frame in frames)
        first = first or seconds
        found, false, total = judged(options, frames)
        print(f'| {workers} | {seconds:.2f} | {seconds / first:.2f} | '
              f'{100 * first * options.workers[0] / (seconds * workers):.0f} % | {sent:.2f} | '
              f'{found}/{total} | {false} | {rate:.1f} | {fetched:.0f} |', flush=True)


class Versions:
    """Two versions of one model, which take turns in the library."""

    MODEL = 'banana'

    def __init__(self, group, options):
        self.group, self.count = group, 0
        other = group.folder / 'other'
        number = json.loads((group.library / self.MODEL / 'model.json').read_text(encoding='utf-8'))['number']
        mesh = pathlib.Path(options.bop) / 'models' / f'obj_{number:06}.ply'
        sh(group.programs / 'bpa', 'model', 'from-mesh', mesh, '--scale', '0.001', '--name', self.MODEL, '--number',
           str(number), '--views', '60', '--spacing', '0.003', '--library', other)
        self.folders = [group.library / self.MODEL, other / self.MODEL]

    def swap(self):
        self.count += 1
        folder, other = self.folders  # the front has mapped the files: they may move, not change
        kept = folder.with_name(f'.{self.count}')
        folder.rename(kept)
        other.rename(folder)
        self.folders[1] = kept
        loaded = self.group.client('load', self.MODEL)
        if loaded.returncode:
            raise SystemExit(loaded.stdout + loaded.stderr)


def block_cache(group, number):
    """A worker that can keep no model: its cache is a file."""
    cache = group.folder / f'cache{number}'
    shutil.rmtree(cache)
    cache.touch()

    def undo():
        cache.unlink()
        cache.mkdir()
    return undo


def strike(kind, hosts, group, rng):
    """One fault while a search runs; returns how it is undone."""
    time.sleep(rng.uniform(0, 1.5))
    worker = group.processes['worker2']
    if kind == 'stopped':
        worker.send_signal(signal.SIGSTOP)
        return lambda: worker.send_signal(signal.SIGCONT)
    if kind == 'killed':
        group.stop('worker2')
        return lambda: group.worker(2)
    if kind == 'cut off':
        hosts.link(2, False)
        return lambda: hosts.link(2, True)
    if kind == 'slow':
        hosts.slow(2, '20mbit')
        return lambda: hosts.slow(2, '')
    if kind == 'library changed':  # while it runs: it goes on with the version that it began with
        group.client('unload', 'banana')
        return lambda: group.client('load', 'banana')
    if kind == 'two fronts':  # the second one hears no other, and serves
        hosts.link(3, False)
        time.sleep(2)

        def join():
            before = group.log('second').count('this one waits')
            hosts.link(3, True)
            end = time.monotonic() + 30
            while group.log('second').count('this one waits') == before:
                if time.monotonic() > end:
                    raise SystemExit('both fronts serve:\n' + group.log('second')[-2000:])
                time.sleep(0.1)
        return join
    if kind == 'front killed':
        group.stop('front')

        def start_again():
            group.front('front', 0, '--set', 'group.strength=1')
            time.sleep(4)
        return start_again
    raise SystemExit(kind)


def placed(frame):
    """Model and position (mm) of what the best interpretation is sure of."""
    best = frame['interpretations'][0]['placements'] if frame['interpretations'] else []
    return [(int(one['obj_id']), [1000 * x for x in one['pose']['translation_m']])
            for one in best if one['probability'] >= 0.5]


def judged(options, frames):
    """Objects found, objects that are 20 mm or more from every true one of their model, and true ones."""
    found, false, total = 0, 0, 0
    for frame in frames:
        path = pathlib.Path(options.bop) / 'test' / f'{frame["scene_id"]:06}' / 'scene_gt.json'
        truth = json.loads(path.read_text(encoding='utf-8'))[str(frame['im_id'])]
        total += len(truth)
        for number, where in placed(frame):
            right = [one for one in truth
                     if one['obj_id'] == number and math.dist(one['cam_t_m2c'], where) < 20]
            found += bool(right)
            false += not right
            if right:
                truth.remove(right[0])
    return found, false, total


def faults(options):
    print(f'| fault | answers of {options.times} | found of {options.times} | false | models missing, named | refused '
          '| without an answer | slowest, s | the front, the first worker: descriptors, threads, MB, after the first '
          'and the last |\n|---|---|---|---|---|---|---|---|---|')
    rng = random.Random(1)
    budget = ['--budget-ms', str(options.budget_ms)] if options.budget_ms else []
    for kind in options.kinds:
        with cell(options, 4) as (hosts, group):
            group.front('front', 0, '--set', 'group.strength=1')
            if kind in ('front killed', 'two fronts'):
                group.front('second', 3)
            group.worker(1)
            group.worker(2)
            group.wait_for(2)
            one = ['--scenes', options.scene]
            frames, usual, text = detect(group, options, *one)
            usually = judged(options, frames)
            versions = Versions(group, options) if kind == 'wrong version' else None
            counts = {'found': 0, 'refused': 0, 'none': 0, 'answered': 0, 'missing': 0, 'false': 0}
            slowest, wrong, before = 0, '', ''
            for k in range(options.times):
                path = group.folder / 'answer.json'
                path.unlink(missing_ok=True)
                if kind == 'wrong version':  # worker 2 cannot have it
                    undo = block_cache(group, 2)
                    versions.swap()
                began = time.monotonic()
                client = group.begin('detect', '--bop', options.bop, '--json', path, '--wait', '240', *one,
                                     *budget)
                if kind != 'wrong version':
                    undo = strike(kind, hosts, group, rng)
                text = client.communicate(timeout=300)[0]
                slowest = max(slowest, time.monotonic() - began)
                frames = frames_of(path) if path.exists() else []
                if frames:
                    counts['answered'] += 1
                    found, false, _ = judged(options, frames)
                    counts['found'] += found
                    counts['missing'] += any('not searched' in frame['message'] for frame in frames)
                    counts['false'] += false
                elif 'refused' in text or 'unavailable' in text or 'not searched' in text:
                    counts['refused'] += 1
                else:
                    counts['none'] += 1
                    wrong = wrong or text
                undo()
                group.wait_for(2)
                if k == 0:
                    time.sleep(7)
                    before = group.held()
            time.sleep(7)  # leases of those that were killed
            after = group.held()
        print(f'| {kind} | {counts["answered"]} | {counts["found"]} ({usually[0]} a search without a fault) | '
              f'{counts["false"]} ({usually[1]}) | {counts["missing"]} | {counts["refused"]} | {counts["none"]} | '
              f'{slowest:.1f} (without a fault {usual:.1f}) | {before} -> {after} |', flush=True)
        if wrong:
            print(wrong[-600:], file=sys.stderr)


def discovery(options):
    """From the start of a worker until the front can give it work."""
    print(f'| how hosts find one another | seconds until a worker has joined, median of {options.times} '
          '| largest |\n|---|---|---|')
    for kind in ('multicast', 'static peers', 'discovery server'):
        with cell(options, 3) as (hosts, group):
            peers = []
            if kind != 'multicast':
                for host in range(3):
                    sh('ip', '-n', hosts.name(host), 'link', 'set', 'eth0', 'multicast', 'off')
            if kind == 'static peers':
                peers = ['--set', 'network.peers=[10.77.0.1]']
            if kind == 'discovery server':
                group.processes['discovery'] = subprocess.Popen(
                    ['ip', 'netns', 'exec', hosts.name(2), 'fast-discovery-server', '-i', '0', '-l',
                     '10.77.0.3', '-p', '11811'], stdout=subprocess.DEVNULL)
                group.environment['ROS_DISCOVERY_SERVER'] = '10.77.0.3:11811'
                time.sleep(1)
            group.front()
            log = group.folder / 'front.log'
            while 'serves as' not in log.read_text(encoding='utf-8'):
                time.sleep(0.05)
            times = []
            for number in range(options.times):
                group.start(f'worker{number}', 1, '--role', 'worker', '--threads', '1', '--set',
                            f'group.cache={group.folder}/cache', *peers)
                size = log.stat().st_size
                began = time.monotonic()
                while ' joined' not in log.read_text(encoding='utf-8')[size:]:
                    time.sleep(0.01)
                    if time.monotonic() - began > 30:
                        break
                times.append(time.monotonic() - began)
                group.stop(f'worker{number}')
                time.sleep(2)
        print(f'| {kind} | {statistics.median(times):.2f} | {max(times):.2f} |', flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('what', choices=['scale', 'faults', 'discovery'])
    parser.add_argument('--library', required=True)
    parser.add_argument('--bop', default='')
    parser.add_argument('--programs', type=pathlib.Path, default=PROGRAMS, help='folder of bpa-server')
    parser.add_argument('--workers', type=int, nargs='+', default=[1, 2, 4])
    parser.add_argument('--clients', type=int, default=4)
    parser.add_argument('--share', type=float, default=0, help='of a processor, of each worker; 0: all')
    parser.add_argument('--times', type=int, default=20)
    parser.add_argument('--scene', default='1', help='whose frames are searched under faults, and by several clients')
    parser.add_argument('--budget-ms', type=float, default=0)
    parser.add_argument('--kinds', nargs='+',
                        default=['killed', 'stopped', 'cut off', 'slow', 'wrong version', 'library changed',
                                 'front killed', 'two fronts'])
    options = parser.parse_args()
    {'scale': scale, 'faults': faults, 'discovery': discovery}[options.what](options)


if __name__ == '__main__':
    main()
