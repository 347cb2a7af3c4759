"""Damage a file: each `Damage` takes the path of a good file and leaves something bad there."""

from __future__ import annotations

import gzip
import os
import random
from collections.abc import Callable
from pathlib import Path

Damage = Callable[[Path], None]

#: Control characters that a terminal would obey.
ESCAPES = "\x1b[31m\x1b]0;owned\x07\u202e\r\x00"
TEX = r"$\frac{_^%"
#: A YAML text that holds some 10^9 values once its aliases are replaced.
BOMB = "a: &a [x,x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{b}: &{b} [{','.join([f'*{a}'] * 10)}]\n" for a, b in zip("abcdefgh", "bcdefghi", strict=True)
)


def replace_by(content: bytes) -> Damage:
    """Return a damage that replaces the content of a file by `content`."""

    def damage(path: Path) -> None:
        path.write_bytes(content)

    return damage


def change(edit: Callable[[bytes], bytes]) -> Damage:
    """Return a damage that replaces the content of a file by `edit(content)`."""

    def damage(path: Path) -> None:
        path.write_bytes(edit(path.read_bytes()))

    return damage


def put(make: Callable[[Path], object]) -> Damage:
    """Return a damage that deletes a file, then calls `make` with the path of the file.

    `make` may leave a folder, a pipe, a link or nothing at the path.
    """

    def damage(path: Path) -> None:
        path.unlink()
        make(path)

    return damage


def flip(seed: int, bits: int = 1) -> Damage:
    """Return a damage that flips `bits` bits of a file, at random positions drawn from `seed`."""

    def edit(content: bytes) -> bytes:
        chosen, changed = random.Random(seed), bytearray(content)
        for _ in range(bits):
            changed[chosen.randrange(len(changed))] ^= 1 << chosen.randrange(8)
        return bytes(changed)

    return change(edit)


def insert(text: bytes, part: float = 0.5) -> Damage:
    """Return a damage that inserts `text` behind the first `part` of a file, e.g. 0.5: half."""
    return change(lambda c: c[: int(part * len(c))] + text + c[int(part * len(c)) :])


#: Name -> damage that any file can take.
ANY = {
    "empty": replace_by(b""),
    "one_byte": replace_by(b"\xff"),
    "zeros": replace_by(b"\0" * 5000),
    "text": replace_by(b"just some text\n"),
    "escapes": replace_by(ESCAPES.encode()),
    "invalid_utf8": replace_by(b"seed: \xff\xfe\x80\nname: \xed\xa0\x80\n"),
    "utf16": change(lambda c: c.decode("latin-1").encode("utf-16")),
    "deep": replace_by(b"[" * 100_000 + b"]" * 100_000),
    "deep_mapping": replace_by(b'{"a":' * 50_000 + b"1" + b"}" * 50_000),
    "bomb": replace_by(BOMB.encode()),
    "list": replace_by(b"[1, 2, 3]\n"),
    "number": replace_by(b"1e999\n"),
    "null": replace_by(b"null\n"),
    "half": change(lambda c: c[: len(c) // 2]),
    "twice": change(lambda c: c + c),
    "escape_inside": insert(ESCAPES.encode()),
    "nul_inside": insert(b"\0\0\0\0"),
    "flipped": flip(1),
    "flipped_often": flip(2, 40),
    "folder": put(lambda path: path.mkdir()),
    "pipe": put(os.mkfifo),
    "endless_device": put(lambda path: path.symlink_to("/dev/zero")),
    "null_device": put(lambda path: path.symlink_to(os.devnull)),
    "dangling_link": put(lambda path: path.symlink_to("nowhere")),
    "link_to_itself": put(lambda path: path.symlink_to(path.name)),
    "gone": put(lambda path: None),
}

_TABLE = b"time,x,y\n"
_ROWS = b"".join(b"%.2f,%.4f,%.4f\n" % (0.1 * k, 0.1 * (k % 7), 0.2 * (k % 5)) for k in range(300))

#: Name -> damage of a text table. What is left may be a valid record or an invalid one.
TEXT = {
    "header_alone": replace_by(_TABLE),
    "one_row": replace_by(_TABLE + b"0,1,2\n"),
    "text_in_the_middle": insert(b"\nhello,world,!\n"),
    "open_quote": insert(b'\n"1,2,3\n'),
    "long_line": insert(b"1" * 2_000_000),
    "ragged": replace_by(_TABLE + b"0,1\n1,2,3,4,5\n\n2\n" * 20),
    "nan": replace_by(_TABLE + b"nan,nan,nan\n" * 100),
    "infinite": replace_by(_TABLE + _ROWS.replace(b"0.2000", b"inf")),
    "huge_numbers": replace_by(_TABLE + _ROWS.replace(b"0.2000", b"1e308")),
    "huge_steps": replace_by(_TABLE + b"".join(b"%g,1,2\n" % (1e6 * k) for k in range(100))),
    "time_stands_still": replace_by(_TABLE + b"1.0,1,2\n" * 100),
    "time_falls": replace_by(_TABLE + b"".join(b"%d,1,2\n" % (100 - k) for k in range(100))),
    "one_late_jump": replace_by(_TABLE + _ROWS + b"1e15,1,2\n"),
    "same_names": replace_by(b"time,time,time\n" + _ROWS),
    "no_names": replace_by(b",,\n" + _ROWS),
    "tex_names": replace_by(b"time," + TEX.encode() + b",%s{0}\n" + _ROWS),
    "escapes_in_names": replace_by(b"time,x\x1b[31m\x07,y\xe2\x80\xae\n" + _ROWS),
    "pipes_in_names": replace_by(b"time,x|y,<script>\n" + _ROWS),
    "long_names": replace_by(b"time," + b"x" * 10_000 + b",y\n" + _ROWS),
    "formula": replace_by(b"time,=cmd|' /C calc'!A0,y\n" + _ROWS),
    "semicolons": replace_by((_TABLE + _ROWS).replace(b",", b";").replace(b".", b",")),
    "tabs": replace_by((_TABLE + _ROWS).replace(b",", b"\t")),
    "utf16": ANY["utf16"],
    "byte_order_mark": change(lambda c: b"\xef\xbb\xbf" + c),
    "latin_1": replace_by(b"time,x,temp_\xb0C\n" + _ROWS),
}

#: Name -> damage of a compressed table.
GZIP = {
    "no_gzip": replace_by(_TABLE + _ROWS),
    "cut": change(lambda c: c[:-9]),
    "wrong_sum": change(lambda c: c[:-8] + b"\1\2\3\4" + c[-4:]),
    "garbage_after": change(lambda c: c + b"garbage"),
    "bomb": replace_by(gzip.compress(b"time,x,y\n" + b"0" * 60_000_000, 9)),
}
