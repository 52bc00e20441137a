# SPDX-License-Identifier: MIT
"""The service under a systemd of its own, in a copy of the clean system: what the unit gives and what it takes away. In
place of the tool's command a script runs, which tries what a service that was broken into would."""
import os
import subprocess
import time

from clean import Copy, run

# As in clean.py, and: a root that is no chroot, for user name spaces; shared mounts, for credentials; cgroups.
BOOT = r'''
set -e
mount --make-rprivate /
mount -t overlay overlay -o "lowerdir=$2,upperdir=$3,workdir=$4" "$1"
mount -t proc proc "$1/proc"
mount -t sysfs -o ro sysfs "$1/sys"
mount -t tmpfs -o mode=755 tmpfs "$1/run"
mount -t tmpfs tmpfs "$1/dev"
for node in null zero full random urandom tty; do
    touch "$1/dev/$node"
    mount --bind "/dev/$node" "$1/dev/$node"
done
mkdir "$1/dev/pts" "$1/dev/shm"
mount -t devpts -o newinstance,ptmxmode=0666 devpts "$1/dev/pts"
ln -s pts/ptmx "$1/dev/ptmx"
mount -t cgroup2 cgroup2 "$1/sys/fs/cgroup"
mkdir -p "$1/mnt/old"
cd "$1"
pivot_root . mnt/old
umount -l /mnt/old
mount --make-rshared /
exec env -i container=other PATH=/usr/sbin:/usr/bin:/sbin:/bin /lib/systemd/systemd --log-target=null --show-status=0 \
    --unit=basic.target
'''
TRY = r'''
echo "password: $(cat "$CREDENTIALS_DIRECTORY/fathom-mqtt-password" 2>/dev/null)"
echo "group: $(cat /srv/of_dialout)"
cat /etc/credstore/fathom-mqtt-password >/dev/null 2>&1 && echo "reads the file of the password"
for file in /etc/x /var/x /srv/x /run/x; do touch $file 2>/dev/null && echo "writes $file"; done
[ -e /proc/1 ] && echo "sees process 1"
unshare -U true 2>/dev/null && echo "makes a name space"
grep -E '^(CapEff|CapBnd|NoNewPrivs|Seccomp):' /proc/self/status
/usr/bin/fathom --version
sleep 60
'''
DROP_IN = '[Service]\nType=exec\nExecStart=\nExecStart=/bin/sh /srv/try.sh\nStandardOutput=file:/run/told\n'
NONE = '0000000000000000'
TOLD = ['password: {}', 'group: read by dialout', f'CapEff:\t{NONE}', f'CapBnd:\t{NONE}', 'NoNewPrivs:\t1',
        'Seccomp:\t2', 'fathom {}']
START = ('rm -f /run/told; systemctl daemon-reload; systemctl start fathom-publish.service || exit; '
         'for try in $(seq 50); do grep -q ^fathom /run/told || sleep 0.1; done; cat /run/told; '
         'systemctl stop fathom-publish.service')


def file_of(copy, path, text, mode=0o644):
    path = os.path.join(copy.upper, path)
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, 'w', encoding='ascii') as file:
        file.write(text)
    os.chmod(path, mode)
    return path


def problems(base, packages, version):
    with Copy(base, os.path.join(base.folder, 'copy')) as copy:
        copy.put(packages[0])
        status, said = copy.apt('install', f'/srv/{os.path.basename(packages[0])}')
        if status != 0:
            yield f'apt-get install: {said[-300:]}'
            return
        file_of(copy, 'etc/fathom/publish.yaml', 'site: x\n')
        password = file_of(copy, 'etc/credstore/fathom-mqtt-password', 'a password\n', 0o600)
        file_of(copy, 'srv/try.sh', TRY)
        os.chown(file_of(copy, 'srv/of_dialout', 'read by dialout\n', 0o640), 0, 20)  # Debian's number of the group
        file_of(copy, 'etc/systemd/system/fathom-publish.service.d/try.conf', DROP_IN)
        for has_password in (True, False):
            if not has_password:
                os.remove(password)
            apart = ['unshare', '--mount', '--pid', '--ipc', '--uts', '--net', '--cgroup', '--fork', '--kill-child']
            with subprocess.Popen([*apart, 'sh', '-c', BOOT, 'boot', copy.root, base.root, copy.upper, copy.work],
                                  stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as init:
                try:
                    status, said = inside(init.pid, START)
                finally:
                    init.kill()  # and by --kill-child all that runs below it
            wanted = [line.format('a password' if has_password else '') if 'password' in line else line.format(version)
                      for line in TOLD]
            if status != 0 or said.splitlines() != wanted:
                yield f'exit status {status}, {said.splitlines()}, not {wanted}'


def inside(pid, script, seconds=30):
    """A script in the system whose init is the child of this process, once it is up."""
    deadline, status, said = time.monotonic() + seconds, None, 'no init'
    while time.monotonic() < deadline:
        with open(f'/proc/{pid}/task/{pid}/children', encoding='ascii') as file:
            child = file.read().split()
        if child:
            enter = ['nsenter', '-t', child[0], '--mount', '--pid', '--net', 'timeout', '-s', 'KILL', '20', 'sh', '-c']
            status, said = run([*enter, '[ -d /run/systemd/system ] && systemctl is-system-running'])
            if said.strip() in ('running', 'degraded'):
                return run([*enter, script])
        time.sleep(0.2)
    return status, f'systemd does not come up: {said}'
