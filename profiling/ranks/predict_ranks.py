"""Predicted time of a step of one world on many ranks: a pile of balls, divided by a Hilbert curve, with messages that
cost time for each message and for each byte."""
import dataclasses
import math

import numpy as np


@dataclasses.dataclass
class Network:
    """Costs of messages. The values are typical published ones, not measured, unless `name` says so."""
    name: str
    latency: float     # from sending an empty message to its arrival [s]
    overhead: float    # time of the sender and receiver for each further message of an exchange [s]
    bandwidth: float   # of a rank, while all ranks of a machine send [bytes/s]


# 16 ranks share the adapter of a machine. Half of the bytes leave the machine.
INFINIBAND = Network("InfiniBand, 200 Gb/s", 1.5e-6, 0.5e-6, 2 * 25e9 / 16)
ETHERNET = Network("Ethernet, 25 Gb/s", 25e-6, 2e-6, 2 * 3.1e9 / 16)


@dataclasses.dataclass
class Costs:
    """Work and messages of a step."""
    body: float                  # time of a body on one core [s]
    ghost: float = 0             # time of a copy of a body of another rank, as a share of `body`
    threads: float = 6.5         # speed-up of the 8 threads of a rank
    imbalance: float = 1.1       # work of the slowest rank over the mean
    nodes: int = 124             # nodes of a body: drop_ball.msh
    contacts: float = 1.8        # contacts of a body with each of its six neighbours
    label_rounds: int = 2
    # bytes of a predicted velocity, of a label, of a contact with its results, and of a node that a contact moved
    prediction: int = 24
    label: int = 20
    row: int = 280
    result: int = 56


@dataclasses.dataclass
class Volume:
    """Messages of a step, the mean over all ranks. `ghosts`: copies that a rank holds."""
    ghosts: float
    peers: float
    messages: float
    bytes: float


def hilbert_index(cell, bits):
    """Place of cells (rows of three integers below 2^bits) on a Hilbert curve (J. Skilling, 2004)."""
    x = [cell[:, i].astype(np.int64) for i in range(3)]
    step = 1 << (bits - 1)
    while step > 1:
        for i in range(3):
            high = (x[i] & step) != 0
            flip = np.where(high, step - 1, 0)
            swap = np.where(high, 0, (x[0] ^ x[i]) & (step - 1))
            x[0] ^= flip ^ swap
            x[i] ^= swap
        step >>= 1
    x[1] ^= x[0]
    x[2] ^= x[1]
    turn = np.zeros_like(x[0])
    step = 1 << (bits - 1)
    while step > 1:
        turn ^= np.where((x[2] & step) != 0, step - 1, 0)
        step >>= 1
    index = np.zeros_like(x[0])
    for bit in range(bits - 1, -1, -1):
        for i in range(3):
            index = index << 1 | ((x[i] ^ turn) >> bit & 1)
    return index


def owners_by_curve(edges, ranks):
    """Owner of each ball of a block of balls, as an array of three dimensions."""
    cells = np.indices(edges).reshape(3, -1).T
    order = np.argsort(hilbert_index(cells, max(2, math.ceil(math.log2(max(edges))))), kind="stable")
    owner = np.empty(len(cells), np.int32)
    owner[order] = np.arange(len(cells)) * ranks // len(cells)
    return owner.reshape(edges)


def neighbours(owner):
    """For each ball the owners of the 26 balls around it; its own owner where there is no ball."""
    around = []
    for shift in np.ndindex(3, 3, 3):
        moved = owner.copy()
        to, start = [], []
        for s, n in zip(shift, owner.shape):
            to.append(slice(max(0, 1 - s), min(n, n + 1 - s)))
            start.append(slice(max(0, s - 1), min(n, n + s - 1)))
        moved[tuple(to)] = owner[tuple(start)]
        around.append(moved.ravel())
    return np.stack(around, axis=1)


def block_of(balls):
    """Edges of a block of about so many balls."""
    edge = max(1, round(balls ** (1 / 3)))
    return edge, edge, max(1, round(balls / edge ** 2))


def volume(balls, ranks, costs):
    """Counts the messages of a pile of balls."""
    edges = block_of(balls)
    owner = owners_by_curve(edges, ranks)
    of_ball = owner.ravel()
    around = np.sort(neighbours(owner), axis=1)
    holders = 1 + (np.diff(around, axis=1) != 0).sum(axis=1)  # ranks that hold the ball, with its owner
    copies = holders - 1
    pairs = np.unique(of_ball[:, None].astype(np.int64) * ranks + around)
    peers = (len(pairs) - ranks) / ranks  # without the pairs of a rank with itself; both orders occur
    copies_at = copies.reshape(edges)
    sent = copies.sum() * costs.nodes * costs.prediction
    for axis in range(3):
        first = tuple(slice(0, -1) if i == axis else slice(None) for i in range(3))
        second = tuple(slice(1, None) if i == axis else slice(None) for i in range(3))
        copies_of_pair = (copies_at[first] + copies_at[second]).sum()
        crossing = (owner[first] != owner[second]).sum()
        # A contact has two nodes in each body. Half of the contacts that cross ranks are found by another rank than
        # the one that solves them.
        sent += costs.contacts * (2 * copies_of_pair * (costs.label + costs.result) + crossing / 2 * costs.row)
    exchanges = 3 + costs.label_rounds  # predictions, labels, rows, results
    return Volume(copies.sum() / ranks, peers, exchanges * peers, sent / ranks)


def step_time(balls, ranks, costs, network):
    """Time of a step [s]."""
    if ranks == 1:
        return balls * costs.body / costs.threads
    v = volume(balls, ranks, costs)
    work = (costs.imbalance * balls / ranks + costs.ghost * v.ghosts) * costs.body / costs.threads
    waits = v.messages / v.peers * network.latency + v.messages * network.overhead if v.peers else 0
    reduction = math.ceil(math.log2(ranks)) * network.latency
    return work + waits + reduction + v.bytes / network.bandwidth
