"""A real Slurm cluster of this machine alone, for tests: munged, slurmctld and two slurmd, with all of their files in one folder.

Needs Debian's packages slurm-wlm and munge, and to be root, as slurmd is. Nothing of the machine's own Slurm is used or changed.
"""
import os
import re
import shutil
import signal
import socket
import subprocess
import time

SKIPPED = 77
PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol")
NODES = ("node1", "node2")
PATIENCE_S = 30

CONFIGURATION = """ClusterName=hermite
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort={ports[0]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CryptoType=crypto/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=1,sched_interval=1,batch_sched_delay=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
MessageTimeout=5
SlurmdTimeout=6
SlurmctldTimeout=6
KillWait=4
MinJobAge=300
InactiveLimit=0
SlurmctldDebug=info
SlurmdDebug=info
NodeName={nodes[0]} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs={cpus} RealMemory={memory_mb} State=UNKNOWN
NodeName={nodes[1]} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs={cpus} RealMemory={memory_mb} State=UNKNOWN
PartitionName=scans Nodes=ALL Default=YES MaxTime=60 State=UP
"""


def why_not():
    """Why there can be no cluster here; None: there can."""
    for program in PROGRAMS:
        if not shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin:/usr/bin"):
            return f"{program} is not installed"
    return None if os.geteuid() == 0 else "slurmd has to be root"


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [listening.getsockname()[1] for listening in sockets]
    for listening in sockets:
        listening.close()
    return ports


class DoesNotRun(Exception):
    """Slurm is installed, but does not run on this machine, as in a container that forbids what it needs."""


class Cluster:
    def __init__(self, folder, cpus=1, memory_mb=16000):
        self.folder = folder
        for name in ("", "/state", *("/" + node for node in NODES)):
            os.makedirs(folder + name, exist_ok=True)
        os.chmod(folder, 0o755)
        self.environment = {**os.environ, "SLURM_CONF": folder + "/slurm.conf", "PATH": os.environ["PATH"] + ":/usr/sbin:/usr/bin"}
        key = os.open(folder + "/munge.key", os.O_WRONLY | os.O_CREAT, 0o400)
        os.write(key, os.urandom(128))
        os.close(key)
        with open(folder + "/slurm.conf", "w", encoding="ascii") as file:
            file.write(CONFIGURATION.format(host=socket.gethostname().split(".")[0], folder=folder, nodes=NODES, ports=free_ports(3), cpus=cpus,
                                            memory_mb=memory_mb))
        self.processes = {}
        try:
            self.start_all()
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            self.end()
            raise DoesNotRun(f"{error}\n{self.last_words()}") from error

    def start_all(self):
        folder = self.folder
        self.start("munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={folder}/munge.key",
                   f"--pid-file={folder}/munge.pid", f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed", "--num-threads=2")
        self.wait(lambda: os.path.exists(folder + "/munge.socket"), "munged listens")
        self.start_controller()
        for node in NODES:
            self.start_node(node)
        self.wait(lambda: self.ask("sinfo", "-h", "-o", "%D %T") == f"{len(NODES)} idle\n", "both nodes are idle")

    def start(self, program, *arguments, name=None):
        log = open(f"{self.folder}/{name or program}.out", "a", encoding="utf-8")
        self.processes[name or program] = subprocess.Popen([program, *arguments], env=self.environment, stdin=subprocess.DEVNULL, stdout=log,
                                                           stderr=log, start_new_session=True)
        log.close()

    def start_controller(self):
        self.start("slurmctld", "-D", "-f", self.folder + "/slurm.conf")
        self.wait(lambda: "UP" in self.ask("scontrol", "ping"), "slurmctld answers")

    def start_node(self, node):
        self.start("slurmd", "-D", "-N", node, "-f", self.folder + "/slurm.conf", name=node)

    def wait(self, condition, what):
        deadline = time.monotonic() + PATIENCE_S
        while not condition():
            if time.monotonic() > deadline:
                raise RuntimeError(f"never: {what}; {self.ask('sinfo', '-N', '-l')}{self.ask('squeue')}")
            time.sleep(0.1)

    def ask(self, *command):
        answer = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=PATIENCE_S)
        return answer.stdout

    def last_words(self):
        """The ends of what the daemons have printed."""
        texts = []
        for name in sorted(entry for entry in os.listdir(self.folder) if entry.endswith((".log", ".out"))):
            with open(f"{self.folder}/{name}", encoding="utf-8", errors="replace") as file:
                texts.append(f"{name}: {file.read()[-500:]}")
        return "\n".join(texts)

    def jobs(self):
        """The fields of all jobs that the controller knows, by their number."""
        answer = self.ask("squeue", "--states=all", "-h", "-O", "JobID:|,State:|,NodeList:|,RestartCnt:|,Name:|")
        rows = (line.split("|") for line in answer.splitlines())
        return {row[0]: dict(zip(("number", "state", "node", "restarts", "name"), row)) for row in rows}

    def kill(self, name):
        """The daemon alone, with SIGKILL."""
        process = self.processes.pop(name)
        process.kill()
        process.wait()

    def cut_off(self, node, number):
        """As if the network of the node had failed: its daemons are gone, and what they have started lives on."""
        self.kill(node)
        for process in processes_with(f"slurmstepd: [{number}."):
            os.kill(process, signal.SIGKILL)
            self.wait(lambda ending=process: has_ended(ending), "slurmstepd is gone")

    def end(self):
        for name in list(self.processes):
            if name != "munged":
                self.processes[name].terminate()
        for name in [*NODES, "slurmctld", "munged"]:
            if name in self.processes:
                try:
                    self.processes[name].terminate()
                    self.processes[name].wait(10)
                except subprocess.TimeoutExpired:
                    self.processes[name].kill()
                    self.processes[name].wait()


def has_ended(process):
    """With all of its threads: until the last one has gone, its children have not lost their parent."""
    try:
        with open(f"/proc/{process}/stat", encoding="ascii") as file:
            is_zombie = file.read().rsplit(")", 1)[1].split()[0] == "Z"
        return is_zombie and len(os.listdir(f"/proc/{process}/task")) <= 1
    except OSError:
        return True


def processes_with(text):
    """Those in whose command line the text stands."""
    found = []
    for entry in os.listdir("/proc"):
        if not re.fullmatch(r"\d+", entry) or int(entry) == os.getpid():
            continue
        try:
            with open(f"/proc/{entry}/cmdline", "rb") as line:
                if text.encode() in line.read():
                    found.append(int(entry))
        except OSError:
            pass
    return found
