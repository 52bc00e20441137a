# SPDX-License-Identifier: MIT
"""Debian's own kernels, out of the packages linux-image-cloud-ARCH. Nothing of the system is touched: apt works with
the system's sources, and with lists and an architecture of its own, as any user."""
import glob
import os
import re
import subprocess
import sys
import tarfile

def apt(folder, *words):
    environment = dict(os.environ, APT_CONFIG=os.path.join(folder, 'apt.conf'))
    done = subprocess.run(words, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        raise RuntimeError(f'{" ".join(words)}: {done.stdout}')
    return done.stdout


def download(folder, architecture):
    """The newest kernel's package, into the folder."""
    for name in ('lists/partial', 'cache/archives/partial'):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
    with open(os.path.join(folder, 'apt.conf'), 'w', encoding='utf-8') as file:
        for name, value in (('APT::Architecture', architecture), ('APT::Architectures', architecture),
                            ('APT::Sandbox::User', 'root'), ('Dir::State', folder),
                            ('Dir::State::Lists', os.path.join(folder, 'lists')),
                            ('Dir::State::status', '/dev/null'), ('Dir::Cache', os.path.join(folder, 'cache')),
                            ('Acquire::Languages', 'none')):
            file.write(f'{name} "{value}";\n')
    apt(folder, 'apt-get', '-q', 'update')
    found = re.search(r'Depends: (linux-image-\S+)',
                      apt(folder, 'apt-cache', 'depends', f'linux-image-cloud-{architecture}'))
    apt(folder, 'apt-get', '-q', 'download', found[1])


def kernel(folder, architecture):
    """The path of the kernel and its version. What is in the folder already is not downloaded again."""
    folder = os.path.join(os.path.abspath(folder), architecture)
    if not glob.glob(os.path.join(folder, 'linux-image-*.deb')):
        download(folder, architecture)
    package, = glob.glob(os.path.join(folder, 'linux-image-*.deb'))
    path = os.path.join(folder, 'vmlinuz')
    if not os.path.exists(path):
        with subprocess.Popen(['dpkg-deb', '--fsys-tarfile', package], stdout=subprocess.PIPE) as unpack:
            with tarfile.open(fileobj=unpack.stdout, mode='r|') as files:
                for one in files:
                    if re.fullmatch(r'\./boot/vmlinuz-.*', one.name):
                        with open(path + '.part', 'wb') as file:
                            file.write(files.extractfile(one).read())
        os.rename(path + '.part', path)
    return path, os.path.basename(package).split('_')[1]


if __name__ == '__main__':  # debian.py FOLDER: before the tests, which need not wait for them then
    for each in ('amd64', 'arm64'):
        print(each, kernel(sys.argv[1], each)[1])
