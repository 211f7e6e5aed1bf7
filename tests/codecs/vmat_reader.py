"""A reader of .vmat files after docs/vmat.md alone, as someone would write it in another language: it knows nothing of our code."""
import re
import struct
import zlib


def bits_of(data):
    """The bits of bytes, the lowest of each first."""
    return [byte >> i & 1 for byte in data for i in range(8)]


SECTIONS = {1: "facts", 2: "tree", 3: "row tree", 4: "row order", 5: "column order", 6: "order of both", 7: "row groups",
            8: "column groups", 9: "boundaries", 10: "row names", 11: "column names", 12: "column levels", 13: "boxes", 14: "bands",
            15: "index", 16: "payload", 17: "list rows"}


class File:
    def __init__(self, data):
        magic, version, self.rows, self.columns, self.ones = struct.unpack_from("<8sIIIQ", data)
        assert magic == bytes.fromhex("89564d41540d0a1a") and version == 4
        self.codec = data[28:60].rstrip(b"\0").decode()
        count, = struct.unpack_from("<I", data, 60)
        table = [struct.unpack_from("<IQ", data, 64 + 12 * i) for i in range(count)]
        numbers, sizes = [number for number, _ in table], [size for _, size in table]
        assert numbers == sorted(set(numbers)) and all(sizes)
        head = 64 + 12 * count
        of_sums, of_head = struct.unpack_from("<2I", data, head)
        assert zlib.crc32(data[:head + 4]) == of_head
        blocks = -(-sum(sizes) // 4096)
        sums, body = data[head + 8:head + 8 + 4 * blocks], data[head + 8 + 4 * blocks:]
        assert len(body) == sum(sizes) and zlib.crc32(sums) == of_sums
        for block in range(blocks):
            assert zlib.crc32(body[4096 * block:4096 * (block + 1)]) == struct.unpack_from("<I", sums, 4 * block)[0]
        self.sections = {name: b"" for name in SECTIONS.values()}
        for number, size in table:
            self.sections[SECTIONS.get(number, f"shared {number - 32}")], body = body[:size], body[size:]

    def places(self):
        """Where each part's bytes begin, and the payload's end."""
        return part_places(self.sections["index"], len(self.sections["payload"]))

    def row(self, row):
        if self.codec in ("bv", "rows-fast-ids", "rows-fast-bits"):
            return rows_of(self.codec, self.rows, self.columns, self.sections["index"], self.sections["payload"])[row]
        places = self.places()
        data = self.sections["payload"][places[row]:places[row + 1]]
        if self.codec == "bitmap" or len(data) == -(-self.columns // 8):  # the escape
            return [column for column, bit in enumerate(bits_of(data)) if bit]
        if self.codec == "panne":
            model = Clusters(self.sections["payload"][:places[0]], self.columns)
            return model.row(data)
        assert self.codec == "delimiter"
        numbers, ids, column = delimiter_numbers(data), [], 0
        for i, (gap, count) in enumerate(zip(numbers[::2], numbers[1::2])):
            column += gap - (i == 0)
            ids += range(column, column + count)
            column += count
        return ids


def part_places(index, u):
    """Where the parts begin in a payload of u bytes, and where it ends."""
    index = Bytes(index)
    n = index.varint()
    if index.at == len(index.data):
        return [part * u // n for part in range(n + 1)] if n else [u]
    if n == 0:
        places = [int.from_bytes(index.take(4), "little") for _ in range((len(index.data) - 1) // 4)]
        assert index.at == len(index.data) and len(places) > 1 and places[-1] == u and places == sorted(places)
        return places
    b = 0 if u < 2 * (n + 1) else (u // (n + 1)).bit_length() - 1
    m = n + 1 + (u >> b)
    width = 8 if m >= 2**32 else 4
    samples = index.take(width * (n // 256))
    high, low = bits_of(index.take(-(-m // 8))), bits_of(index.take(-(-(n + 1) * b // 8)))
    assert index.at == len(index.data)
    set_bits = [place for place, bit in enumerate(high) if bit]
    assert [int.from_bytes(samples[i:i + width], "little") for i in range(0, len(samples), width)] == set_bits[256::256]
    places = [((place - i) << b) + sum(low[i * b + j] << j for j in range(b)) for i, place in enumerate(set_bits)]
    assert len(places) == n + 1 and places[-1] == u and places == sorted(places)
    return places


class Bits:
    """Bits from the lowest of each byte on, codes and lengths among them."""

    def __init__(self, data):
        self.bits, self.at = bits_of(data), 0

    def take(self, count):
        self.at += count
        assert self.at <= len(self.bits)
        return self.bits[self.at - count:self.at]

    def symbol(self, code):
        text = ""
        while text not in code:
            assert len(text) < 15
            text += str(self.take(1)[0])
        return code[text]

    def length(self, code):
        """A length, and which hundred and sixty-eight its symbol is of."""
        kind, symbol = divmod(self.symbol(code), 168)
        if symbol < 64:
            return symbol + 1, kind
        e, mm = 6 + (symbol - 64) // 4, (symbol - 64) % 4
        raw = sum(bit << i for i, bit in enumerate(self.take(e - 2)))
        return (1 << e) + (mm << (e - 2)) + raw, kind

    def finish(self):
        assert len(self.bits) - self.at < 8 and not any(self.bits[self.at:])


def rows_of(codec, rows, columns, index, payload):
    """All rows of codec bv, rows-fast-ids or rows-fast-bits."""
    places = part_places(index, len(payload))
    parts = [payload[begin:end] for begin, end in zip(places, places[1:])]
    model = Bytes(payload[:places[0]])
    if codec == "rows-fast-bits":
        return [row for part in parts for row in four_rows(part, columns)][:rows]
    if codec == "rows-fast-ids":
        gaps, lengths = ([(model.take(1)[0], model.varint()) for _ in range(model.take(1)[0])] for _ in range(2))
    assert model.at == len(model.data)
    found = []
    for part in parts:
        if part and len(part) == -(-columns // 8):  # the escape
            found.append([column for column, bit in enumerate(bits_of(part)) if bit])
        elif codec == "rows-fast-ids":
            found.append(fast_ids(part, gaps, lengths))
        else:
            found.append(row_against_rows(part, found))
    return found


def fast_ids(data, gaps, lengths):
    raw, token, column, ids = 0, len(data), -1, []
    while raw != token:
        assert raw < token
        token -= 1
        numbers = []
        for count, base in (gaps[data[token] & 15], lengths[data[token] >> 4]):
            numbers.append(base + int.from_bytes(data[raw:raw + count], "little"))
            raw += count
        column += numbers[0]
        ids += range(column, column + numbers[1])
        column += numbers[1]
    return ids


def four_rows(part, columns):
    words, bitmap = -(-columns // 64), -(-columns // 8)
    width = 2 if 5 * bitmap < 65536 else 4
    part, ends = part[:-5 * width], part[-5 * width:]
    ends = [int.from_bytes(ends[at:at + width], "little") for at in range(0, 5 * width, width)]
    assert ends == sorted(ends) and ends[-1] == len(part)

    def coded(data, filled):
        """The bytes of a leader or row."""
        if not data:
            return bytes(8 * words)
        data = Bytes(data)
        levels, fills = (bits_of(data.take(-(-words // 8))) if has else 8 * words * [0] for has in (True, filled))
        assert not any(levels[words:]) and not any(fills[words:])
        masks = [data.take(1)[0] if level else 0 for level in levels[:words]]
        found = b"".join(data.take(1) if mask >> i & 1 else bytes([255 * fill]) for mask, fill in zip(masks, fills) for i in range(8))
        assert data.at == len(data.data)
        return found

    leader, found = coded(part[:ends[0]], True), []
    for begin, end in zip(ends, ends[1:]):
        row = part[begin:end]
        bits = bits_of(row if len(row) == bitmap else bytes(a ^ b for a, b in zip(leader, coded(row, False))))
        assert not any(bits[columns:])
        found.append([column for column, bit in enumerate(bits) if bit])
    return found


def row_against_rows(data, rows):
    """A row of codec bv, behind the rows before it."""
    if not data:
        return []
    bits, x = Bits(data), len(rows)

    def number(count):
        return sum(bit << i for i, bit in enumerate(bits.take(count)))

    def zeros():
        count = 0
        while bits.take(1) == [0]:
            count += 1
        return count

    def g():
        below = zeros()
        return (1 << below) + number(below) - 1

    def z():
        h = zeros()
        value = number(3 * h + 2)
        return (value + 8**h if value < 8**h else 2 * value + number(1)) - 1

    def s(n):
        return n // 2 if n % 2 == 0 else -(n + 1) // 2

    d, r = g(), zeros()
    assert d and r <= 7
    ids = []
    if r:
        reference, copied = rows[x - r], True
        blocks = [g() + (b > 0) for b in range(g())]
        assert sum(blocks) <= len(reference)
        for block in blocks + [len(reference) - sum(blocks)]:
            ids += reference[:block] if copied else []
            reference, copied = reference[block:], not copied
    if len(ids) < d:
        end = None
        for _ in range(g()):
            begin = x + s(g()) if end is None else end + 1 + g()
            end = begin + g() + 4
            ids += range(begin, end)
        last = None
        while len(ids) < d:
            last = x + s(z()) if last is None else last + 1 + z()
            ids.append(last)
    bits.finish()
    assert len(ids) == len(set(ids)) == d
    return sorted(ids)


def huffman_code(data, at, symbols):
    """Symbols by their codes as text, and where the code's bytes end."""
    lengths = []
    while len(lengths) < symbols:
        lengths += [data[at] & 15] * ((data[at] >> 4) + 1)
        at += 1
    assert len(lengths) == symbols
    codes, code, last = {}, 0, 0
    for length, symbol in sorted((length, symbol) for symbol, length in enumerate(lengths) if length):
        code <<= length - last
        codes[format(code, f"0{length}b")], last = symbol, length
        code += 1
    return codes, at


class Clusters:
    """The model of codec panne."""

    def __init__(self, model, columns):
        clusters, at, shift = 0, 0, 0
        while True:
            byte, at = model[at], at + 1
            clusters |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        self.steps, at = huffman_code(model, at, 3 * 168 + 1)
        self.runs, at = huffman_code(model, at, 168)
        self.at_column = [[] for _ in range(columns)]  # a cluster: its lead, its steps
        if clusters:
            self.ranks, at = huffman_code(model, at, 168)
            leads, at = huffman_code(model, at, 168)
            heads, at = huffman_code(model, at, 168)
            bits = Bits(model[at:])
            counts = [bits.length(heads)[0] - 1 for _ in range(columns)]
            assert sum(counts) == clusters
            for column, count in enumerate(counts):
                for _ in range(count):
                    self.at_column[column].append((bits.length(leads)[0] - 1, self.read_steps(bits)))
            bits.finish()
        else:
            assert at == len(model)

    def read_steps(self, bits):
        steps = []
        while True:
            number, kind = bits.length(self.steps)
            if kind == 3:
                return steps
            code = (None, self.runs, self.ranks)[kind] if kind else None
            steps.append((number - 1, kind, bits.length(code)[0] if code else 1))

    def follow(self, steps, reach):
        """Ids of steps in turn, and where each begins and reaches to."""
        ids, places = [], []
        for zeros, kind, count in steps:
            begin = reach + zeros
            if kind == 2:
                inner, reach = self.cluster(begin, count)
                ids += inner
            else:
                reach = begin + (count + 1 if kind else 1)
                ids += range(begin, reach)
            places.append((begin, reach))
        return ids, places

    def cluster(self, column, rank):
        lead, steps = self.at_column[column][rank - 1]
        ids, reach = self.cluster(column, lead) if lead else ([column], column + 1)
        more, places = self.follow(steps, reach)
        for begin, end in places:
            if begin == reach:
                reach = end
        return ids + more, reach

    def row(self, data):
        if not data:
            return []
        bits = Bits(data)
        steps = self.read_steps(bits)
        bits.finish()
        ids = sorted(self.follow(steps, 0)[0])
        assert steps and len(set(ids)) == len(ids)
        return ids


def delimiter_code(number):
    text = bin(number)[2:].replace("11", "110")
    return text + "1" if text.endswith("01") or text == "1" else text


def delimiter_bytes(numbers):
    text = "11".join(map(delimiter_code, numbers)) + "1" if numbers else ""
    text += "0" * (-len(text) % 8)
    return bytes(int(text[i:i + 8][::-1], 2) for i in range(0, len(text), 8))


def delimiter_numbers(data):
    """By trying: the codes of numbers in turn that the bits can begin with, until one way leads to the end."""
    text = "".join(map(str, bits_of(data))).rstrip("0")[:-1]
    ways = [(0, [])]
    while ways:
        at, numbers = ways.pop()
        for length in range(1, min(50, len(text) - at) + 1):
            code, end = text[at:at + length], at + length
            plain = code[:-1] if code.endswith("11") else code
            number = int(plain.replace("110", "11"), 2) if plain[0] == "1" else 0
            if number and delimiter_code(number) == code:
                if end == len(text):
                    return numbers + [number]
                if text.startswith("111", end):
                    ways.append((end + 2, numbers + [number]))
    assert not data
    return []


class Bytes:
    def __init__(self, data):
        self.data, self.at = data, 0

    def byte(self):
        self.at += 1
        return self.data[self.at - 1]

    def varint(self):
        value = shift = 0
        while True:
            byte = self.byte()
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    def take(self, count):
        self.at += count
        assert self.at <= len(self.data)
        return self.data[self.at - count:self.at]

    def question_tree(self):
        """A question and two trees, or a probability out of 2^14. Takes whole bytes."""
        pool = []  # bits of the last byte that are left

        def number(count):
            while len(pool) < count:
                pool.extend(bits_of([self.byte()]))
            value = sum(bit << i for i, bit in enumerate(pool[:count]))
            del pool[:count]
            return value

        def node():
            if number(1):
                question = number(6)
                return question, node(), node()
            code = number(8)
            h, z = code & 127, code >> 7
            s = h if h < 8 else (8 + h % 8) << (h // 8 - 1)
            return 2**14 - s if z else s

        tree = node()
        assert not any(pool)
        return tree


class RangeDecoder:
    def __init__(self, data):
        self.data, self.at, self.range, self.code = data, 4, 2**32 - 1, int.from_bytes((data + bytes(4))[:4], "big")

    def bit(self, ones):
        unit = self.range >> 14
        bit = self.code < unit * ones
        start, size = (0, ones) if bit else (ones, 2**14 - ones)
        self.code -= unit * start
        self.range = unit * size
        while self.range < 2**24:
            self.range <<= 8
            self.code = self.code << 8 | (self.data[self.at] if self.at < len(self.data) else 0)
            self.at += 1
        return int(bit)


class Chance:
    def __init__(self):
        self.quick = self.slow = 1 << 15

    def p(self):
        return min(max((self.quick + self.slow) // 8, 64), 2**14 - 64)

    def see(self, bit):
        if bit:
            self.quick += (65535 - self.quick) // 16
            self.slow += (65535 - self.slow) // 128
        else:
            self.quick -= self.quick // 16
            self.slow -= self.slow // 128


class Adaptive:
    """Chances by name, each made when it is first used."""

    def __init__(self, data):
        self.decoder, self.chances = RangeDecoder(data), {}

    def bit(self, *name):
        chance = self.chances.setdefault(name, Chance())
        bit = self.decoder.bit(chance.p())
        chance.see(bit)
        return bit

    def number(self, *name):
        n = 0
        while self.bit(*name, "w", n):
            n += 1
        value = 1
        for i in range(n):
            value = 2 * value + (self.bit(*name, "h", n, value & 7) if i < 3 else self.decoder.bit(2**13))
        return value - 1


class Steps:
    def __init__(self, coder, n):
        self.coder, self.left, self.below = coder, list(range(n)), 0
        self.last, self.before, self.far = True, True, 0

    def step(self):
        above = len(self.left) - self.below
        told = self.below > 0 and above > 0
        up = bool(self.coder.bit("up", self.last, self.before, self.far > 0)) if told else self.below == 0
        number = self.coder.number("between", told and 1 + (up == self.last), min(5, self.far.bit_length()))
        assert number < (above if up else self.below)
        self.below = self.below + number if up else self.below - 1 - number
        self.last, self.before, self.far = up, self.last, number
        return self.left.pop(self.below)


def read_order(data, n):
    """Where each of the source's stands."""
    steps = Steps(Adaptive(data[1:]), n)
    way = [steps.step() for _ in range(n)]
    if data[0] == 1:
        return way
    assert data[0] == 0
    places = [0] * n
    for place, number in enumerate(way):
        places[number] = place
    return places


def read_tree(data):
    """Parents and objects of the nodes, how many objects there are, whether the columns are the nodes."""
    data = Bytes(data)
    flags, objects, n = data.byte(), data.varint(), data.varint()
    coder = Adaptive(data.data[data.at:])
    parents, counts = [], []
    if flags & 3 == 2:
        last = 0
        for node in range(n):
            if node:
                last = coder.number("back", min(3, last.bit_length()))
            parents.append(node - 1 - last if node else None)
    else:
        waiting = []  # nodes that lack children: a queue by levels, a stack by branches
        for node in range(n):
            parent = waiting.pop(0 if flags & 3 == 0 else -1) if node else None
            above = min(3, counts[parent]) if node else 0
            count = coder.number("children", above, min(3, counts[-1]) if node else 0)
            parents.append(parent)
            counts.append(count)
            waiting += [node] * count
        assert not waiting
    held, steps, result, new = [], Steps(coder, objects), [], True
    inner = set(parents)
    for node in range(n):
        if not coder.bit("holds", node in inner):
            result.append(None)
            continue
        new = not held or bool(steps.left) and bool(coder.bit("new", new))
        held.append(steps.step() if new else held[-1 - coder.number("again")])
        result.append(held[-1])
    return parents, result, objects, bool(flags & 4)


def read_groups(data):
    data = Bytes(data)
    n, order = data.varint(), data.varint()
    order = data.take(order)
    code, at = huffman_code(data.data, data.at, 168)
    bits, members, met = Bits(data.data[at:]), [], 0
    for member in range(n):
        back = bits.length(code)[0] - 1
        members.append(members[member - back] if back else met)
        met += back == 0
    bits.finish()
    if order:  # visits the groups' numbers in the order of their first members
        place = read_order(order, met)
        number = sorted(range(met), key=lambda group: place[group])
        members = [number[member] for member in members]
    return members


def read_names(data):
    data, names = Bytes(data), []
    while data.at < len(data.data):
        shared = data.varint()
        names.append((names[-1][:shared] if names else b"") + data.take(data.varint()))
    return [name.decode() for name in names]


def read_levels(data):
    data, levels, last = Bytes(data), [], 0
    while data.at < len(data.data):
        step = data.varint()
        last += step // 2 if step % 2 == 0 else -(step + 1) // 2
        levels.append((last, data.varint()))
    return levels


def read_bands(data):
    data = Bytes(data)
    bands = [0]
    for _ in range(data.varint() - 1):
        bands.append(bands[-1] + data.varint())
    return bands


def gamma_numbers(data):
    bits, numbers = bits_of(data), []
    end = max(i for i, bit in enumerate(bits) if bit) if any(bits) else 0
    at = 0
    while at < end:
        zeros = bits[at:].index(1)
        at += zeros + 1
        numbers.append(1 << zeros | sum(bit << i for i, bit in enumerate(bits[at:at + zeros])))
        at += zeros
    return numbers


class Gotsman:
    """All rows out of a payload over a tree of rows, given as the children and the row of each node."""

    def __init__(self, codec, columns, children, row_of_node, index, payload):
        self.codec, self.columns, self.children = codec, columns, children
        places = part_places(index, len(payload))
        parts = [payload[begin:end] for begin, end in zip(places, places[1:])]
        payload = Bytes(payload[:places[0]])
        everything = payload.byte()
        if codec == "gotsman3-context":
            self.trees = payload.question_tree(), payload.question_tree()
        assert payload.at == len(payload.data)
        seen = range(columns) if everything else self.root(parts.pop(0))
        inner = [node for node in range(len(children)) if children[node]]
        assert len(parts) == len(inner)
        self.parts = dict(zip(inner, parts))
        self.rows = {}
        waiting = [(0, list(seen), [], False)]
        while waiting:
            node, seen, siblings, first = waiting.pop()
            if not children[node]:
                self.rows[row_of_node[node]] = seen
                continue
            b, c = self.split(node, seen, siblings, first)
            waiting.append((children[node][0], b, [set(c)] + siblings, True))
            waiting.append((children[node][1], c, [set(b)] + siblings, False))

    def root(self, data):
        if self.codec != "gotsman3-context":
            return [column for column, bit in enumerate(bits_of(data)) if bit]
        ids, column, numbers = [], -1, gamma_numbers(data)
        for gap, count in zip(numbers[::2], numbers[1::2]):
            column += gap
            ids += range(column, column + count)
            column += count
        return ids

    def leafs(self, node):
        return sum(map(self.leafs, self.children[node])) if self.children[node] else 1

    def split(self, node, a, siblings, first):
        bits = iter(bits_of(self.parts[node]))
        if self.codec == "gotsman1":
            sets = [[column for column in range(self.columns) if next(bits)] for _ in range(2)]
            assert sorted({*sets[0], *sets[1]}) == a
            return sets
        if self.codec == "gotsman2":
            return [[column for column in a if next(bits)] for _ in range(2)]
        if self.codec == "gotsman3":
            b = [column for column in a if next(bits)]
            return b, [column for column in a if column not in b or next(bits)]
        trits, of_column, decoder, seen = [], {}, RangeDecoder(self.parts[node]), set(a)
        history = {column: tuple(column in s for s in siblings) + (False,) * 8 for column in a}
        leafs = self.leafs(node)
        for i, p in enumerate(a):
            answers = [0] * 44

            def trit(at, value):
                answers[at], answers[at + 1] = value & 1, value >> 1

            def last_like(length):
                return next((of_column[q] for q in reversed(a[:i]) if history[q][:length] == history[p][:length]), 0)

            trit(0, of_column.get(p - 1, 0))
            trit(2, of_column.get(p - 2, 0))
            answers[4], answers[5] = p + 1 in seen, p + 2 in seen
            trit(6, trits[-1] if i > 0 else 0)
            trit(8, trits[-2] if i > 1 else 0)
            answers[10:14] = history[p][:4]
            for at, length in zip(range(14, 26, 2), (1, 2, 4, 6, 8, None)):
                trit(at, last_like(length))
            if i > 0:
                answers[26] = history[a[i - 1]][:4] == history[p][:4]
                answers[27] = history[a[i - 1]] == history[p]
            answers[28] = i >= 5 and len(set(trits[-5:])) == 1
            answers[29] = i >= 17 and len(set(trits[-17:])) == 1
            ones, twos, n = (trits.count(value) for value in (1, 2, 3))
            answers[30:38] = (2 * n > i, 4 * n > 3 * i, 8 * n > 7 * i, 32 * n > 31 * i, 4 * n < i, ones > twos,
                              ones > 3 * twos, twos > 3 * ones)
            answers[38:43] = (leafs <= most for most in (2, 4, 8, 32, 128))
            answers[43] = first

            def bit(tree):
                while isinstance(tree, tuple):
                    tree = tree[2 if answers[tree[0]] else 1]
                return decoder.bit(tree)

            trits.append(3 if bit(self.trees[0]) else 2 if bit(self.trees[1]) else 1)
            of_column[p] = trits[-1]
        return [p for p in a if of_column[p] & 1], [p for p in a if of_column[p] & 2]


class Stream:
    """Decisions, choices and numbers of modelled rows, under the weights and chances of row_tables.cpp."""

    def __init__(self, data, tables):
        self.weights, self.chances = tables
        self.data, self.at, self.range, self.code = data, 0, 2**64 - 1, 0
        for _ in range(2):
            self.more()

    def more(self):
        self.code = self.code << 32 | int.from_bytes((self.data[self.at:] + bytes(4))[:4], "big")
        self.at += 4

    def narrow(self, start, size):
        self.code -= start
        self.range = size
        while self.range < 2**32:
            self.range <<= 32
            self.more()

    def decision(self, *places):
        total = sum(self.weights[place] for place in places)
        u = self.chances[min(abs(total), 160)]
        bound = (self.range >> 16) * (u if total >= 0 else 2**16 - u)
        bit = self.code < bound
        self.narrow(*((0, bound) if bit else (bound, self.range - bound)))
        return int(bit)

    def choice(self, n):
        return self.weighted([1] * n)

    def weighted(self, weights):
        """Which of the weights, each as likely as it is large."""
        unit = self.range // sum(weights)
        left, value = self.code // unit, 0
        assert left < sum(weights)
        while left >= weights[value]:
            left -= weights[value]
            value += 1
        self.narrow(unit * sum(weights[:value]), unit * weights[value])
        return value

    def number(self, kind, most):
        t, e = most.bit_length() - 1, 0
        while e < t and self.decision(3872 + 192 * kind + 16 * min(t, 11) + min(e, 15)):
            e += 1
        if e == 0:
            return 1
        low, middle, high = 2**e, 3 * 2**(e - 1), most if e == t else 2**(e + 1) - 1
        if high < middle:
            return low + self.choice(high - low + 1)
        if self.decision(6752 + 16 * kind + min(e, 15)):
            return middle + self.choice(high - middle + 1)
        return low + self.choice(middle - low)


class ModelledRows:
    """All rows of a payload of rows-small or rows-quick."""

    def __init__(self, rows, columns, index, payload, tables):
        self.columns = columns
        places = part_places(index, len(payload))
        model = Bytes(payload[:places[0]])
        kept = model.varint()
        stream = Stream(payload[model.at:places[0]], tables)
        self.common, before = [], (1, 1)  # runs that rows may name, as (first column, the one behind, weight)
        for _ in range(stream.number(11, 4097 if columns > 2 else 1) - 1):
            start = before[0] + stream.number(12, columns - 1 - before[0]) - 1
            least = before[1] if start == before[0] else start
            before = (start, least + stream.number(13, columns - 1 - least))
            self.common.append((*before, 2**(stream.number(14, 6) - 1)))
        self.names_second = stream.decision(7067)
        groups, last, first = [], 0, kept  # of each its first row, its size, its reference's number, the group that this is in
        for i in range(len(places) - 1):
            size = stream.number(6, min(16, rows - first))
            if i == 0 or stream.decision(7010):
                last = (last + stream.number(8, kept + 1) - 1) % (kept + 1)
                groups.append((first, size, last, None))
            else:
                above, tried = i - 1, 0
                while above is not None and tried < 8 and stream.decision(7011 + tried):
                    above, tried = groups[above][3], tried + 1
                if above is None or tried == 8:
                    above = i - stream.number(9, i)
                groups.append((first, size, groups[above][0] + stream.number(7, groups[above][1]), above))
            first += size
        assert first == rows
        self.seen, self.reference = [[0] * columns], [0]  # by number
        for r in range(kept):
            self.read(stream, r + 1 - stream.number(9, r + 1), 0, r, [])
        for g, ((first, size, outside, above), begin, end) in enumerate(zip(groups, places, places[1:])):
            way, last, inside = [], outside, above  # the numbers of the rows decoded on the way to its first one, the last one first
            while inside is not None:
                way += range(last, groups[inside][0], -1)
                last, inside = groups[inside][2:]
            stream = Stream(payload[begin:end], tables)
            for place in range(size):
                reference = outside
                if place > 0:
                    back = next((i for i in range(place) if not stream.decision(6993 + i)), None)
                    if back is not None:
                        reference = first + place - back
                    elif stream.decision(7009):
                        reference = stream.choice(kept + 1)
                earlier = list(range(first + place, first, -1))
                self.read(stream, reference, 1 if place == 0 else 2, kept, (earlier + way)[:255])
        self.rows = [[column for column, bit in enumerate(row) if bit] for row in self.seen[1:]]

    def read(self, stream, reference, stands, kept, way):
        if stream.decision(6992):
            row = self.bitmap(stream)
        else:
            seen_a, second, named = self.seen[reference], self.reference[reference], 0
            ends = sum(bit != before for bit, before in zip(seen_a, [0] + seen_a))
            context = 8 * stands + min(7, ends.bit_length())
            if self.names_second and stream.decision(7019 + context):
                named = 1
                if not way or stream.decision(7043 + context):
                    second = stream.choice(kept + 1)
                else:
                    second = way[stream.number(10, len(way)) - 1]
            row = self.row(stream, seen_a, self.seen[second], named)
        self.seen.append(row)
        self.reference.append(reference)

    def bitmap(self, stream):
        bits = []
        for column in range(0, self.columns, 16):
            count = min(16, self.columns - column)
            value = stream.choice(2**count)
            bits += [value >> i & 1 for i in range(count)]
        return bits

    def row(self, stream, seen_a, seen_b, named):
        ends_a, ends_b = ({column for column in range(self.columns) if row[column] != (row[column - 1] if column else 0)}
                          for row in (seen_a, seen_b))
        row = list(seen_a)
        starts = sorted({0} | ends_a | ends_b) + [self.columns]

        def class_of(n):
            return min(7, (n - 1).bit_length())

        def g(v):
            return 2 * v.bit_length() + (v > 1 and v >> (v.bit_length() - 2) & 1)

        left = stream.number(5, len(ends_a) + len(ends_b) + 2) - 1
        history = f = segment = 0
        history_of, agreed_of = [0, 0], [0, 0]  # of segments where A is 0, and where it is 1
        while left:
            begin, end = starts[segment], starts[segment + 1]
            segment += 1
            n, a = end - begin, seen_a[begin]
            d, c = a ^ seen_b[begin], class_of(n)
            behind_a, behind_b = end == self.columns or end in ends_a, end == self.columns or end in ends_b
            z = 1 + sum(column > begin for column in ends_a) + sum(column > begin for column in ends_b)
            r = min(15, max(0, g(z) - g(left)))
            s, e = a + 2 * d + 4 * (begin in ends_a) + 8 * (begin in ends_b) + 16 * f, behind_a + 2 * behind_b
            changed = stream.decision(s + 32 * behind_a + 64 * behind_b + 128 * c,
                                      1024 + d + 2 * (agreed_of[a] & 7) + 16 * (history_of[a] & 7) + 128 * named + 256 * min(c, 3),
                                      2048 + r + 16 * (min(left, 8) - 1) + 128 * c)
            history = 2 * history + changed
            history_of[a] = 2 * history_of[a] + changed
            if changed or d:
                agreed_of[a] = 2 * agreed_of[a] + (changed & d)
            left -= changed

            def flip(first, count):
                row[first:first + count] = [1 - a] * count

            f = 0
            if not changed:
                continue
            if n == 1 or stream.decision(3072 + s + 32 * c, 3328 + (history & 15) + 16 * e):
                flip(begin, n)
                f = 1
                continue
            at = begin
            if stream.decision(3392 + s + 32 * c):
                count = stream.number(0, n - 1)
                flip(at, count)
                at += count
                if end - at < 2 or not stream.decision(3784 + class_of(end - at)):
                    continue
            while True:
                m = end - at
                if m == 2 or stream.decision(3648 + class_of(m) + 8 * e + 32 * d):
                    count = stream.number(1, m - 1)
                    flip(end - count, count)
                    f = 1
                    break
                last = m == 3 or stream.decision(3776 + class_of(m))
                fitting = [run for run in self.common if at < run[0] < end] if m > 3 else []
                slots = sum(weight for _, _, weight in fitting)
                if slots and stream.decision(3792 + 8 * min(slots.bit_length(), 9) + class_of(m)):
                    first, behind, _ = fitting[stream.weighted([weight for _, _, weight in fitting])]
                    assert behind + (not last) < end
                elif last:
                    count = stream.number(2, m - 2)
                    first = at + 1 + stream.choice(m - 1 - count)
                    behind = first + count
                else:
                    first = at + stream.number(3, m - 3)
                    behind = first + stream.number(4, end - first - 2)
                flip(first, behind - first)
                at = behind
                if last:
                    break
        return row


def row_tables(source):
    """The two lists of numbers in the text of row_tables.cpp."""
    lists = re.findall(r"= \{\n([-0-9,\n]+)\};", source)
    weights, chances = ([int(number) for number in numbers.replace("\n", "").split(",") if number] for numbers in lists)
    assert (len(weights), len(chances)) == (7068, 161)
    return weights, chances
