"""Debian's PREEMPT_RT kernel for the virtual machine: fetched by apt, which checks it, and unpacked
without installing it."""

import fcntl
import lzma
import shutil
import struct
import subprocess
import tarfile
import tempfile
from pathlib import Path

# In the order of loading.
MODULES = [
    "net/can/can",
    "net/can/can-raw",
    "drivers/net/can/dev/can-dev",
    "drivers/net/can/vcan",
    "net/sched/sch_plug",
    "drivers/gpio/gpio-generic",
    "drivers/gpio/gpio-amdpt",
]
XZ_MAGIC = b"\xfd7zXZ\0"


class KernelMissing(RuntimeError):
    pass


def _apt(command, **options):
    done = subprocess.run(command, text=True, capture_output=True, check=False, **options)
    if done.returncode != 0:
        raise KernelMissing(
            "the virtual machine needs Debian's kernel with PREEMPT_RT (70 MB, once), and apt "
            "cannot get it: is there a network? Are apt's lists there (apt-get update)?\n"
            f"{' '.join(command)}: {done.stderr.strip()}"
        )
    return done.stdout


def _download(folder):
    words = _apt(["apt-cache", "depends", "linux-image-rt-amd64"]).split()
    package = next((word for word in words if word.startswith("linux-image-6")), None)
    if package is None:
        raise KernelMissing("linux-image-rt-amd64 depends on no kernel; is this Debian on amd64?")
    # Else apt warns that its own user may not write here.
    _apt(["apt-get", "-q", "-o", "APT::Sandbox::User=root", "download", package], cwd=folder)
    return next(Path(folder).glob(f"{package}_*.deb"))


def _decompressed(kernel):
    """The ELF file in a bzImage: decompressing it in the virtual machine takes half of the boot, as
    long as it is XZ's; from Debian 13 on it is not, and QEMU gets the bzImage as it is. Offsets from
    the kernel's Documentation/x86/boot.rst."""
    setup_sectors = kernel[0x1F1] or 4
    offset, length = struct.unpack_from("<II", kernel, 0x248)
    start = (setup_sectors + 1) * 512 + offset
    payload = kernel[start : start + length]
    if not payload.startswith(XZ_MAGIC):
        return kernel
    return lzma.LZMADecompressor().decompress(payload)


def _unpack(package, folder):
    """Leaves vmlinux and the modules, flat."""
    wanted = {f"{module}.ko" for module in MODULES}
    listing = subprocess.Popen(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE)
    with tarfile.open(fileobj=listing.stdout, mode="r|") as members:
        for member in members:
            inner = member.name.partition("/kernel/")[2]
            module = inner.removesuffix(".xz")  # from Debian 13 on
            if module in wanted or member.name.startswith("./boot/vmlinuz-"):
                contents = members.extractfile(member).read()
                if not inner:
                    (folder / "vmlinux").write_bytes(_decompressed(contents))
                else:
                    is_plain = inner == module
                    plain = contents if is_plain else lzma.decompress(contents)
                    (folder / Path(module).name).write_bytes(plain)
    if listing.wait() != 0 or not _is_complete(folder):
        raise KernelMissing(f"{package.name} lacks a kernel or one of {', '.join(MODULES)}")


def _is_complete(folder):
    names = ["vmlinux"] + [f"{Path(module).name}.ko" for module in MODULES]
    return all((folder / name).exists() for name in names)


def kernel_folder(cache):
    """A folder with vmlinux and MODULES, flat. Kept in the folder `cache`; safe to call twice at
    once."""
    cache.mkdir(parents=True, exist_ok=True)
    folder = cache / "kernel"
    with open(cache / "kernel.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not _is_complete(folder):
            shutil.rmtree(folder, ignore_errors=True)
            with tempfile.TemporaryDirectory(dir=cache) as scratch:
                unpacked = Path(scratch) / "kernel"
                unpacked.mkdir()
                _unpack(_download(scratch), unpacked)
                unpacked.rename(folder)
    return folder
