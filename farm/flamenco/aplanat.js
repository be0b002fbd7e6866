// SPDX-License-Identifier: GPL-3.0-or-later
//
// A job type for Flamenco 3: renders, captures or refocuses frames with Aplanat, some frames a task.
// How to install it, and what happens when a frame fails: docs/farm.md.

const JOB_TYPE = {
    label: "Aplanat",
    description: "Render through a camera lens, capture depth layers, or refocus captured ones",
    settings: [
        // For artists to decide.
        {
            key: "make",
            type: "string",
            required: true,
            choices: ["render", "capture", "refocus"],
            default: "render",
            description:
                "render: pictures of this scene; capture: its depth layers, to be refocused later;" +
                " refocus: pictures of captured layers",
        },
        {
            key: "frames",
            type: "string",
            required: true,
            eval: "f'{C.scene.frame_start}-{C.scene.frame_end}'",
            evalInfo: { showLinkButton: true, description: "Scene frame range" },
            description: "Frames, such as 47 or 1-30 or 3,5-10",
        },
        {
            key: "chunk_size",
            type: "int32",
            default: 5,
            propargs: { min: 1 },
            visible: "submission",
            description: "Frames that a worker takes at a time; each task starts Blender once",
        },
        {
            key: "options",
            type: "string",
            default: "--strict",
            description:
                "Further words of the command. With --strict a missing library or image makes the" +
                " task fail; without, it is a warning in the log",
        },
        {
            key: "layers",
            type: "string",
            subtype: "file_path",
            description: "To refocus: the captured files, such as /shots/7/layers_######.exr",
        },
        {
            key: "render_output_root",
            type: "string",
            subtype: "dir_path",
            required: true,
            visible: "submission",
            description: "Folder for the files; the job's name is appended",
        },
        {
            key: "add_path_components",
            type: "int32",
            default: 0,
            propargs: { min: 0, max: 32 },
            visible: "submission",
            description: "Folders of the blend file's path that the output's path has, too",
        },
        {
            key: "file_name",
            type: "string",
            required: true,
            default: "frame_######.exr",
            visible: "submission",
            description: "###### becomes the frame number; .exr, or .png if rendered or refocused",
        },
        {
            key: "render_output_path",
            type: "string",
            subtype: "file_path",
            editable: false,
            eval:
                "str(Path(abspath(settings.render_output_root)," +
                " last_n_dir_parts(settings.add_path_components), jobname, settings.file_name))",
            description: "Where the files will be",
        },
        // Filled in by Flamenco's add-on.
        { key: "blendfile", type: "string", required: true, visible: "web" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const input = settings.make === "refocus" ? settings.layers : settings.blendfile;
    if (!input) {
        throw "Name the captured files to refocus, such as /shots/7/layers_######.exr";
    }
    for (const chunk of frameChunker(settings.frames, settings.chunk_size)) {
        const task = author.Task(settings.make + "-" + chunk, "blender");
        // Not Flamenco's own command for Blender, which renders with Blender's words. A worker has a
        // task fail when its process ends with another exit code than 0.
        const command = author.Command("exec", {
            exe: "{blender}",
            args: [
                "--command",
                "aplanat",
                settings.make,
                input,
                "--output",
                settings.render_output_path,
                "--make-folders",
                "--frames=" + chunk,
                "--options=" + (settings.options || ""),
            ],
        });
        task.addCommand(command);
        job.addTask(task);
    }
}
