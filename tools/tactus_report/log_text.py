"""What a log says beside its cycles: informations, parameters, and the files that the run was made of."""

import dataclasses
import re
import struct

MAGIC = bytes([0x55, 0x4C, 0x6F, 0x67, 0x01, 0x12, 0x35])
HEADER_SIZE = 16


@dataclasses.dataclass
class LogText:
    infos: dict  # "joint/1" and so on: text
    parameters: dict  # numbers of scene and robot by their key, "/" in place of "." and "["
    sources: dict  # path: text
    overrides: dict  # key: value, by --set

    def source(self, ending):
        """The text of the only file whose name ends so; None without one."""
        found = [text for path, text in self.sources.items() if path.endswith(ending)]
        return found[0] if len(found) == 1 else None

    def joints(self):
        return self.listed("joint")

    def module_links(self):
        return self.listed("tactile_module")

    def listed(self, name):
        found = []
        while f"{name}/{len(found) + 1}" in self.infos:
            found.append(self.infos[f"{name}/{len(found) + 1}"])
        return found


def read_log_text(path):
    """None where the file is no ULog. Of one that is cut off, what is there."""
    with open(path, "rb") as file:
        if not file.read(HEADER_SIZE).startswith(MAGIC):
            return None
        infos, parameters, lists = {}, {}, {}
        for kind, payload in messages(file):
            if kind == b"A":  # subscriptions: definitions are over
                break
            if kind == b"I":
                name, value = keyed(payload)
                infos[name] = value.decode("utf-8", "replace")
            elif kind == b"P":
                name, value = keyed(payload)
                parameters[name] = struct.unpack("<f", value)[0]
            elif kind == b"M" and payload:
                name, value = keyed(payload[1:])
                texts = lists.setdefault(name, [])
                if payload[0] and texts:
                    texts[-1] += value
                else:
                    texts.append(value)
    texts = {name: [value.decode("utf-8", "replace") for value in values]
             for name, values in lists.items()}
    return LogText(infos, parameters,
                   dict(zip(texts.get("source_path", []), texts.get("source_text", []))),
                   dict(zip(texts.get("override_key", []), texts.get("override_value", []))))


def messages(file):
    while len(header := file.read(3)) == 3:
        size = struct.unpack("<H", header[:2])[0]
        payload = file.read(size)
        if len(payload) < size:
            return
        yield header[2:3], payload


def keyed(payload):
    """The name and the bytes of "char[5] name" with a value."""
    end = 1 + payload[0]
    return payload[1:end].decode("utf-8", "replace").split(" ", 1)[-1], payload[end:]


def tip_of(log):
    """The URDF link that is the tool, by robot.yaml or --set; None where neither says it plainly."""
    if "robot.tip" in log.overrides:
        return log.overrides["robot.tip"]
    for text in log.sources.values():
        found = re.search(r"^tip:\s*[\"']?([^\s\"'#]+)", text, re.MULTILINE)
        if found and re.search(r"^urdf:", text, re.MULTILINE):
            return found.group(1)
    return None
