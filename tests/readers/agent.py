"""Calls the tools of `socam-host mcp` by the protocol's own client, and prints what it got as JSON: agent.py PROGRAM FOLDER CALLS.json [ARGUMENT...].

CALLS is a list of [tool, arguments]. ARGUMENTs follow `mcp`.
"""

import asyncio
import base64
import json
import sys

from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client


def shown(part):
    if part.type == "image":
        return {"image": base64.b64decode(part.data)[:8].hex(), "type": part.mime_type}
    return part.text


async def main():
    program, folder, calls, *arguments = sys.argv[1:]
    server = StdioServerParameters(command=program, args=["mcp", *arguments], cwd=folder)
    async with stdio_client(server) as streams, ClientSession(*streams) as session:
        begun = await session.initialize()
        tools = (await session.list_tools()).tools
        answers = []
        with open(calls) as file:
            for name, given in json.load(file):
                answer = await session.call_tool(name, given)
                answers.append({"error": answer.is_error, "content": [shown(part) for part in answer.content]})
        listed = {tool.name: sorted(tool.input_schema["properties"]) for tool in tools}
        read_only = [tool.name for tool in tools if tool.annotations.read_only_hint]
        print(json.dumps({"server": begun.server_info.name, "tools": listed, "read_only": read_only, "answers": answers}))


asyncio.run(main())
