# SPDX-License-Identifier: MIT
"""A clean Debian of the release that this machine has: debootstrap's minimal one, with the man pages' reader, a
compiler and the like added, but nothing that the packages are to bring. It is made once, and each test gets a copy that
is thrown away: an overlay in name spaces of its own, with its own processes and pseudo terminals."""
import os
import shutil
import subprocess

# What a machine has on which the packages are tried: init, man, a shell's completions; a compiler for libfathom-dev.
TOOLS = ('systemd', 'man-db', 'bash-completion', 'gcc', 'libc6-dev', 'make', 'cmake', 'pkg-config')
APT = ('env', 'DEBIAN_FRONTEND=noninteractive', 'apt-get', '-q', '-y', '--no-install-recommends',
       '-o', 'Binary::apt-get::APT::Keep-Downloaded-Packages=true')
# The root is $1; of an overlay the base is $2, what is written $3, work $4. Nothing of it is seen outside.
ENTER = r'''
set -e
mount --make-rprivate /
[ -z "$2" ] || mount -t overlay overlay -o "lowerdir=$2,upperdir=$3,workdir=$4" "$1"
mount -t proc proc "$1/proc"
mount -t tmpfs tmpfs "$1/dev"
for node in null zero full random urandom tty; do
    touch "$1/dev/$node"
    mount --bind "/dev/$node" "$1/dev/$node"
done
mkdir "$1/dev/pts"
mount -t devpts -o newinstance,ptmxmode=0666 devpts "$1/dev/pts"
ln -s pts/ptmx "$1/dev/ptmx"
ln -s /proc/self/fd "$1/dev/fd"
root=$1
shift 4
exec chroot "$root" "$@"
'''


def run(command, **options):
    """(exit status, what it printed)"""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, errors='replace', check=False, **options)
    except subprocess.TimeoutExpired as error:
        return 124, f'it went on for {error.timeout:g} s'
    return done.returncode, done.stdout


def must(command, **options):
    status, said = run(command, **options)
    if status != 0:
        raise SystemExit(f'{" ".join(command)}: exit status {status}\n{said[-4000:]}')
    return said


def mirrors():
    """Lines of a sources.list: where this machine's apt gets its release, its updates and its security updates."""
    with open('/etc/os-release', encoding='utf-8') as file:
        codename = dict(line.rstrip().split('=', 1) for line in file if '=' in line)['VERSION_CODENAME'].strip('"')
    form = '$(REPO_URI) $(RELEASE) $(COMPONENT)'
    rows = sorted({tuple(row.split()) for row in
                   must(['apt-get', 'indextargets', '--format', form, 'Created-By: Packages']).splitlines()})
    rows = [row for row in rows if row[1].split('-')[0] == codename and row[2] == 'main']
    main = [row for row in rows if row[1] == codename]
    if not main:
        raise SystemExit(f'apt knows no mirror of {codename}')
    return codename, main[0][0], [f'deb {" ".join(row)}\n' for row in rows]


class Base:
    """The root that the copies are of."""

    def __init__(self, folder):
        self.folder, self.root = folder, os.path.join(folder, 'root')
        self.made = os.path.join(folder, 'root.made')

    def inside(self, *command):
        return ['unshare', '--mount', '--pid', '--fork', '--kill-child', 'sh', '-c', ENTER, 'enter', self.root, '', '',
                '', *command]

    def make(self):
        codename, mirror, sources = mirrors()
        wanted = ' '.join((codename, *TOOLS))
        if os.path.exists(self.made):
            with open(self.made, encoding='utf-8') as file:
                if file.read() == wanted:
                    return
            os.remove(self.made)
        shutil.rmtree(self.root, ignore_errors=True)
        os.makedirs(self.folder, exist_ok=True)
        must(['debootstrap', '--variant=minbase', codename, self.root, mirror])
        with open(os.path.join(self.root, 'etc/apt/sources.list'), 'w', encoding='utf-8') as file:
            file.writelines(sources)
        shutil.copy('/etc/resolv.conf', os.path.join(self.root, 'etc/resolv.conf'))
        must(self.inside(*APT, 'update'))
        must(self.inside(*APT, 'install', *TOOLS))
        must(self.inside('apt-get', 'clean'))
        with open(self.made, 'w', encoding='utf-8') as file:
            file.write(wanted)

    def fetch(self, packages):
        """Downloads what these files depend on, where it is not there yet; nothing is installed."""
        place = os.path.join(self.root, 'var/tmp/fathom')
        shutil.rmtree(place, ignore_errors=True)
        os.mkdir(place)
        names = [f'/var/tmp/fathom/{os.path.basename(shutil.copy(package, place))}' for package in packages]
        download = self.inside(*APT, 'install', '--download-only', *names)
        if run(download)[0] != 0:
            must(self.inside(*APT, 'update'))  # a mirror forgets old versions
            must(download)
        shutil.rmtree(place)


class Copy:
    """A copy of the base, in which commands may be run; `with Copy(base) as root`."""

    def __init__(self, base, folder):
        self.base, self.folder = base, folder
        self.root, self.upper, self.work = (os.path.join(folder, name) for name in ('root', 'upper', 'work'))

    def __enter__(self):
        shutil.rmtree(self.folder, ignore_errors=True)
        for path in (self.root, self.upper, self.work):
            os.makedirs(path)
        os.chmod(self.upper, 0o755)
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder, ignore_errors=True)

    def put(self, *paths, to='srv'):
        """Files of this machine into a folder of the copy. Between two commands what was written lies in `upper`."""
        place = os.path.join(self.upper, to)
        os.makedirs(place, exist_ok=True)
        for path in paths:
            shutil.copy(path, place)

    def run(self, *command, seconds=120):
        """(exit status, what it printed); of a single word: a script of sh."""
        if len(command) == 1:
            command = ('sh', '-c', command[0])
        return run(['unshare', '--mount', '--pid', '--fork', '--kill-child', 'sh', '-c', ENTER, 'enter', self.root,
                    self.base.root, self.upper, self.work, 'env', '-i', 'PATH=/usr/sbin:/usr/bin:/sbin:/bin',
                    'LC_ALL=C.UTF-8', 'HOME=/root', *command], timeout=seconds)

    def apt(self, *words):
        return self.run(*APT, *words)
