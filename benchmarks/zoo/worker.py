"""A process that judges scenes: one line of JSON in, one line of JSON out.

    python -m benchmarks.zoo.worker

A request is ``{"seed": 1, "number": 7}`` (with ``"draw": true`` the scene is drawn and not
judged) or ``{"recipe": {...}, "ask": ["disagrees"]}``; the answer holds the verdict's fields and,
for the first form, the recipe. Whatever Blender prints goes to
stderr. A scene that hangs or crashes ends this process only; `run` starts another one.
"""

import json
import os
import sys
from dataclasses import asdict


def main():
    """Answer requests until there are none."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    import bpy

    import addon

    from .judge import Fault, judge
    from .scenes.recipe import make_recipe

    addon.register()
    print(json.dumps({"ready": True}), file=answers)
    for line in sys.stdin:
        request = json.loads(line)
        recipe = request.get("recipe")
        if recipe is None:
            recipe = make_recipe(bpy, request["seed"], request["number"])
            # What is stored and read again must be what was judged.
            recipe = json.loads(json.dumps(recipe))
        if request.get("draw"):
            answer = {}
        else:
            answer = asdict(judge(recipe, request.get("ask", Fault.KINDS)))
        if "recipe" not in request:
            answer["recipe"] = recipe
        print(json.dumps(answer), file=answers)


if __name__ == "__main__":
    main()
